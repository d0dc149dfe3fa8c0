// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// The page: chooses the source of bytes, handles the buttons, and decides what is shown.

import { Library } from './library.js';
import { Lidar } from './lidar.js';
import { SerialSource, hasWebSerial } from './serial.js';
import { SimulatedSource } from './simulation.js';
import { NetworkSource, isServed } from './network.js';
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
const MASKED_MAX = 8;
const MOUNTING = ['mount-front', 'mount-upside-down', 'mount-mask'];

// Reports whether a field's text is good, to the user as well.
function judge(input, isGood, advice) {
    input.setCustomValidity(isGood ? '' : advice);
    input.setAttribute('aria-invalid', String(!isGood));
    return isGood;
}

// Degrees from -360 to 360, as the tool takes them; NaN: something else.
function degreesOf(text, form = /^-?\d{1,3}$/) {
    const degrees = form.test(text) ? Number(text) : NaN;
    return Math.abs(degrees) <= 360 ? degrees : NaN;
}

// "170:190, 350:10" as pairs of degrees.
function arcsOf(text) {
    return text.split(',').map((part) => part.trim()).filter((part) => part !== '')
        .map((part) => part.split(':').map((end) => degreesOf(end.trim())));
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
        show('watch', isServed());
        if (isServed()) {
            this.#watch();
        }
    }

    // ---------------------------------------------------------------------------------- sources

    #next(action) {
        this.#change = this.#change.then(action);
    }

    #watch() {
        this.#next(() => this.#useLidar(new NetworkSource(this.#library)));
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
            onBytes: (bytes, time) => this.#recorder.add(bytes, time),
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
        showScan(numbers, sectors, this.#isBlocked());
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
        showScan(numbers, sectors, this.#isBlocked());
        this.#showAge();
    }

    // ------------------------------------------------------------------------------------- state

    #numbers() {
        return this.#lidar ? this.#library.numbers('lidar_numbers')
            : this.#player ? this.#library.numbers('recording_numbers') : null;
    }

    #count() {
        const numbers = this.#numbers();
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

    #isBlocked() {
        const { FAULT_ENCODER, FAULTS_UNKNOWN } = this.#constants;
        const faults = this.#faults(this.#numbers());
        return faults !== FAULTS_UNKNOWN && (faults & FAULT_ENCODER) !== 0;
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
        show('panel-lidar', lidar !== null && !source.listensOnly);
        show('panel-unit', !source?.listensOnly); // It cannot be asked.
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
        this.#on('watch', 'click', () => this.#watch());
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
        for (const id of MOUNTING) {
            this.#on(id, 'input', () => this.#mount());
        }
        addEventListener('hashchange', () => this.#recallMounting());
        this.#recallMounting();
        this.#listenToColours();
        this.#on('zoom-in', 'click', () => this.#picture.enlarge(1.5));
        this.#on('zoom-out', 'click', () => this.#picture.enlarge(1 / 1.5));
        this.#on('zoom-whole', 'click', () => this.#picture.enlarge(0));
        new Pointer(element('picture'), this.#picture);
    }

    // Applies the fields' mounting, unless one of them is wrong: then the last one stays.
    #mount() {
        const [front, mask] = [element('mount-front'), element('mount-mask')];
        const arcs = arcsOf(mask.value);
        const degrees = degreesOf(front.value, /^-?\d{1,3}(\.\d{1,6})?$/);
        const isFront = judge(front, !Number.isNaN(degrees), 'Degrees, -360 to 360');
        const isMask = judge(mask, arcs.length <= MASKED_MAX && arcs.every((arc) => arc.length === 2) &&
            !arcs.flat().some(Number.isNaN), 'Like this: 170:190, 350:10');
        const advice = front.validationMessage || mask.validationMessage;
        setText('mount-wrong', advice === '' ? '' : `Not applied. ${advice}`);
        if (!isFront || !isMask) {
            return;
        }
        this.#library.hand(new Uint8Array(Int16Array.from(arcs.flat()).buffer));
        this.#library.call('shown_mask', arcs.length);
        this.#library.call('shown_mount', Math.round(degrees * 64), element('mount-upside-down').checked ? 1 : 0);
        this.#keepMounting();
        this.#showAgain();
    }

    // The mounting is in the page's address: it is there after a reload, and in a bookmark, for each lidar another.
    #keepMounting() {
        const kept = new URLSearchParams();
        for (const id of MOUNTING) {
            const { type, checked, value, defaultValue } = element(id);
            if (type === 'checkbox' ? checked : value !== defaultValue) {
                kept.set(id, type === 'checkbox' ? '1' : value);
            }
        }
        if (kept.toString() !== location.hash.slice(1)) {
            history.replaceState(null, '', `#${kept}`);
        }
    }

    #recallMounting() {
        const kept = new URLSearchParams(location.hash.slice(1));
        for (const id of MOUNTING) {
            const field = element(id);
            field.checked = kept.get(id) === '1';
            field.value = kept.get(id) ?? field.defaultValue;
        }
        this.#mount();
    }

    // Light or dark as the system is, also when that changes; the user can choose the other one.
    #listenToColours() {
        const box = element('light');
        const system = matchMedia('(prefers-color-scheme: light)');
        const apply = () => {
            document.documentElement.classList.toggle('light', box.checked);
            this.#picture.retheme();
        };
        const follow = () => {
            box.checked = system.matches;
            apply();
        };
        this.#on('light', 'change', apply);
        system.addEventListener('change', follow);
        follow();
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
