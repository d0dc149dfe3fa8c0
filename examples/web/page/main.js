// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// The page: chooses the source of bytes, handles the buttons, and decides what is shown.

import { Library } from './library.js';
import { Lidar } from './lidar.js';
import { SerialSource, hasWebSerial } from './serial.js';
import { SimulatedSource } from './simulation.js';
import { Recording } from './recording.js';
import { Player } from './player.js';
import { offerSwitches, resetSwitches } from './switches.js';
import { Picture } from './picture.js';
import { Recorder, save } from './saving.js';
import { Pointer } from './pointer.js';
import { explainOpening, faultAdvice, problems, recordingProblems } from './problems.js';
import { element, enable, hertz, isEnabled, log, setText, show, showCounters, showCt, showProblem, showScan,
         showUnit } from './panels.js';

const COUNTERS_MS = 250;
const SECTORS = 8;
const STALE_MS = 1000; // An older scan is out of date.

// "170:190, 350:10" as pairs of degrees; none if the text has another form.
function arcsOf(input) {
    const parts = input.value.split(',').map((part) => part.trim()).filter((part) => part !== '');
    const arcs = parts.map((part) => part.match(/^(-?\d{1,3})\s*:\s*(-?\d{1,3})$/)?.slice(1).map(Number));
    const isGood = !arcs.includes(undefined) && arcs.length <= 8;
    input.setCustomValidity(isGood ? '' : 'Like this: 170:190, 350:10');
    input.setAttribute('aria-invalid', String(!isGood));
    return isGood ? arcs : [];
}

class Viewer {
    #library;
    #constants;
    #picture;
    #lidar = null;
    #player = null;
    #recorder;
    #scannedAt = null; // When the lidar's latest scan came.
    #isStale = false; // That is too long ago.
    #change = Promise.resolve(); // The change from one source to another; only one at a time.

    constructor(library) {
        this.#library = library;
        this.#constants = library.constants;
        this.#recorder = new Recorder(library);
        this.#picture = new Picture(element('picture'), library.constants);
        this.#listen();
        this.#offerFrequencies();
        offerSwitches(library, () => this.#lidar.source);
        this.#update();
        setInterval(() => this.#count(), COUNTERS_MS);
    }

    // ---------------------------------------------------------------------------------- sources

    #next(action) {
        this.#change = this.#change.then(action);
    }

    async #connect() {
        if (!hasWebSerial()) {
            showProblem('problem', problems.noWebSerial);
            return;
        }
        try {
            const source = await SerialSource.choose();
            this.#next(() => this.#useLidar(source));
        } catch (error) {
            this.#cannotConnect(error);
        }
    }

    #cannotConnect(error) {
        const problem = explainOpening(error);
        if (problem !== null) {
            showProblem('problem', problem);
            log('cannot connect', error.message);
        }
    }

    async #useLidar(source) {
        await this.#close();
        this.#lidar = new Lidar(this.#library, source, {
            onEvent: (name, detail) => log(name, detail),
            onScan: () => this.#takeScan(),
            onChange: () => this.#update(),
            onBytes: (bytes) => this.#recorder.add(bytes),
            onProblem: (problem) => showProblem('problem', problem),
        });
        try {
            await this.#lidar.open();
            log('connected', source.name);
        } catch (error) {
            this.#lidar = null;
            this.#cannotConnect(error);
        }
        this.#update();
    }

    async #openFile(file) {
        await this.#close();
        try {
            const recording = new Recording(this.#library, file.name, new Uint8Array(await file.arrayBuffer()));
            showProblem('problem', recording.problem);
            log('recording', file.name);
            this.#player = new Player(recording, {
                onScan: () => this.#takeScan(),
                onJump: () => this.#showAgain(),
            });
        } catch (error) {
            showProblem('problem', recordingProblems.unreadable(file.name, error.message));
        }
        this.#update();
    }

    // Closes the current source and clears what it has shown.
    async #close() {
        const lidar = this.#lidar;
        this.#player?.pause();
        this.#player = null;
        this.#saveRecording();
        if (lidar !== null) {
            await lidar.close();
            log('disconnected', lidar.source.name);
        }
        this.#lidar = null;
        this.#recorder.clear();
        this.#scannedAt = null;
        this.#library.call('shown_forget');
        this.#picture.clear();
        resetSwitches();
        showProblem('problem', null);
        showScan(null);
        this.#update();
    }

    // ------------------------------------------------------------------------------------ scans

    #shown() {
        const numbers = this.#library.numbers('shown_numbers');
        return [this.#library.points('shown_points', numbers.points), numbers,
                this.#library.words('shown_sectors', SECTORS)];
    }

    #takeScan() {
        const [points, numbers, sectors] = this.#shown();
        this.#scannedAt = performance.now();
        this.#picture.add(points, numbers, sectors);
        this.#showAge();
        showScan(numbers, sectors);
    }

    // The scan of a lost or stopped lidar must not look current.
    #showAge() {
        const age = this.#lidar && this.#scannedAt !== null ? performance.now() - this.#scannedAt : 0;
        const isStale = age > STALE_MS;
        this.#isStale = isStale;
        this.#picture.isStale = isStale;
        show('age', isStale);
        if (isStale) {
            const text = `No scan for ${Math.floor(age / 1000)} s`;
            setText('age', text);
            showScan(null);
            setText('summary', `${text}.`);
        }
    }

    #showAgain() {
        const [points, numbers, sectors] = this.#shown();
        this.#picture.replace(points, numbers, sectors);
        showScan(numbers, sectors);
        this.#showAge();
    }

    // ------------------------------------------------------------------------------------- state

    #count() {
        const numbers = this.#lidar ? this.#library.numbers('lidar_numbers')
            : this.#player ? this.#library.numbers('recording_numbers') : null;
        const faultsText = (bits) => this.#library.faultsText(bits);
        this.#showAge();
        showCounters(numbers);
        showCt(numbers, this.#constants, faultsText);
        this.#showFaults(numbers);
        if (this.#recorder.isRunning) {
            setText('record', `Stop recording (${this.#recorder.bytes} bytes)`);
        }
    }

    // The faults: while scanning, from the stream; before, from the answer to the health command.
    #faults(numbers) {
        const { FAULTS_UNKNOWN } = this.#constants;
        if (this.#player) {
            return this.#library.call('recording_faults');
        }
        if (!this.#lidar || numbers.scans + numbers.packets === 0) {
            return this.#lidar?.health?.faults ?? FAULTS_UNKNOWN;
        }
        return this.#library.call('lidar_faults');
    }

    #showFaults(numbers) {
        const faults = this.#isStale ? this.#constants.FAULTS_UNKNOWN : this.#faults(numbers);
        const isKnown = faults !== this.#constants.FAULTS_UNKNOWN;
        setText('faults', isKnown ? this.#library.faultsText(faults) : '–');
        element('faults').classList.toggle('bad', isKnown && faults !== 0);
        if (!isKnown || faults === 0) {
            showProblem('fault', null);
            return;
        }
        const names = this.#library.faultNames(faults);
        const advice = names.map((name) => faultAdvice[name]).filter((text) => text !== undefined);
        showProblem('fault', { title: `The lidar is faulty: ${names.join(', ')}.`, advice });
    }

    #stateName() {
        if (this.#lidar) {
            return this.#lidar.gone ? 'unplugged' : this.#library.text('state_name', this.#lidar.state);
        }
        return this.#player ? 'recording' : 'not connected';
    }

    #update() {
        const lidar = this.#lidar;
        const source = lidar?.source ?? this.#player?.recording;
        setText('source', source?.name ?? '');
        setText('state', this.#stateName());
        show('welcome', !source);
        show('zoom', Boolean(source));
        show('disconnect', Boolean(source));
        show('panel-lidar', lidar !== null);
        show('panel-recording', this.#player !== null);
        show('panel-simulation', source?.kind === 'simulation');
        setText('disconnect', this.#player ? 'Close' : 'Disconnect');
        enable(['save-picture', 'save-csv'], Boolean(source));
        enable(['record'], lidar !== null);
        this.#keepFocus();
        showUnit(lidar?.info ?? null, lidar?.health ?? null, this.#constants, (bits) => this.#library.faultsText(bits));
        if (lidar) {
            this.#updateCommands(lidar);
        }
    }

    #updateCommands(lidar) {
        setText('start-stop', lidar.isScanning ? 'Stop' : 'Start');
        setText('frequency-set', `set: ${hertz(lidar.frequencyChz)}`);
        enable(['start-stop'], !lidar.gone);
        enable(['set-frequency', 'ask-info', 'ask-health', 'reboot'], !lidar.isBusy && !lidar.gone);
    }

    // When the focused button disappears, moves the focus, so that keyboard users keep their place.
    #keepFocus() {
        if (!document.activeElement.checkVisibility()) {
            element(this.#lidar ? 'start-stop' : this.#player ? 'play' : 'connect').focus();
        }
    }

    // ----------------------------------------------------------------------------------- controls

    // A disabled button remains in place and can have the focus, but does nothing.
    #on(id, event, action) {
        const target = element(id);
        target.addEventListener(event, (happened) => isEnabled(target) && action(happened));
    }

    #listen() {
        this.#on('connect', 'click', () => this.#connect());
        this.#on('simulate', 'click', () => this.#next(() => this.#useLidar(new SimulatedSource(this.#library))));
        this.#on('open', 'click', () => element('file').click());
        this.#on('file', 'change', ({ target }) => this.#chosen(target));
        this.#on('disconnect', 'click', () => this.#next(() => this.#close()));
        this.#on('start-stop', 'click', () => this.#lidar.request(this.#lidar.isScanning ? 'stop' : 'start'));
        this.#on('ask-info', 'click', () => this.#lidar.request('info'));
        this.#on('ask-health', 'click', () => this.#lidar.request('health'));
        this.#on('reboot', 'click', () => this.#lidar.request('reboot'));
        this.#on('frequency-form', 'submit', (event) => {
            event.preventDefault();
            if (isEnabled(element('set-frequency'))) {
                this.#lidar.request('frequency', Math.round(element('frequency-wanted').value * 100));
            }
        });
        this.#on('play', 'click', () => this.#player.toggle());
        this.#on('position', 'input', ({ target }) => this.#player.seek(Number(target.value)));
        this.#listenToView();
        this.#listenToSaving();
        this.#listenToDropping();
        addEventListener('pagehide', () => this.#lidar?.abandon());
    }

    #listenToView() {
        this.#on('range', 'change', ({ target }) => {
            this.#picture.rangeMm = Number(target.value);
            this.#picture.draw();
        });
        this.#on('persistence', 'input', ({ target }) => {
            this.#picture.persistence = Number(target.value);
            setText('persistence-value', target.value === '1' ? '1 revolution' : `${target.value} revolutions`);
        });
        for (const id of ['mount-front', 'mount-upside-down', 'mount-mask']) {
            this.#on(id, 'input', () => this.#mount());
        }
        this.#on('light', 'change', ({ target }) => {
            document.documentElement.classList.toggle('light', target.checked);
            this.#picture.retheme();
        });
        this.#on('zoom-in', 'click', () => this.#picture.enlarge(1.5));
        this.#on('zoom-out', 'click', () => this.#picture.enlarge(1 / 1.5));
        this.#on('zoom-whole', 'click', () => this.#picture.enlarge(0));
        new Pointer(element('picture'), this.#picture);
    }

    #mount() {
        const arcs = arcsOf(element('mount-mask'));
        this.#library.hand(new Uint8Array(Int16Array.from(arcs.flat()).buffer));
        this.#library.call('shown_mask', arcs.length);
        this.#library.call('shown_mount', Math.round(Number(element('mount-front').value) * 64),
                           element('mount-upside-down').checked ? 1 : 0);
        this.#showAgain();
    }

    #listenToSaving() {
        this.#on('record', 'click', () => {
            if (!this.#saveRecording()) {
                this.#recorder.start();
                log('recording what comes');
            }
        });
        this.#on('save-picture', 'click', async () => {
            log('saved', save('picture', 'png', [await this.#picture.blob()], 'image/png'));
        });
        this.#on('save-csv', 'click', async () => {
            log('saved', save('points', 'csv', [(await this.#recordingAtHand()).csv()], 'text/csv'));
        });
    }

    // Ends and saves the running recording; returns false if there is none.
    #saveRecording() {
        if (!this.#recorder.isRunning) {
            return false;
        }
        log('saved', this.#recorder.stop());
        setText('record', 'Record');
        return true;
    }

    // The recording that is played; for a lidar, the bytes of the last seconds.
    async #recordingAtHand() {
        if (this.#player) {
            return this.#player.recording;
        }
        const bytes = await new Blob(this.#recorder.parts()).arrayBuffer();
        return new Recording(this.#library, '', new Uint8Array(bytes), false);
    }

    #listenToDropping() {
        addEventListener('dragover', (event) => event.preventDefault());
        addEventListener('drop', (event) => {
            event.preventDefault();
            const [file] = event.dataTransfer.files;
            if (file) {
                this.#next(() => this.#openFile(file));
            }
        });
    }

    #chosen(input) {
        const [file] = input.files;
        input.value = ''; // So that the same file can be chosen again.
        if (file) {
            this.#next(() => this.#openFile(file));
        }
    }

    #offerFrequencies() {
        const { FREQUENCY_MIN_CHZ, FREQUENCY_MAX_CHZ, FREQUENCY_STEP_CHZ } = this.#constants;
        const input = element('frequency-wanted');
        input.min = FREQUENCY_MIN_CHZ / 100;
        input.max = FREQUENCY_MAX_CHZ / 100;
        input.step = FREQUENCY_STEP_CHZ / 100;
        input.value = input.min;
    }
}

function embeddedLibrary() {
    return Uint8Array.from(atob(element('library').textContent.trim()), (letter) => letter.charCodeAt(0));
}

new Viewer(await Library.load(embeddedLibrary()));
