// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// A connected lidar: the library's driver between a source of bytes and the page. The driver carries out commands; this
// file only decides their order.

import { diagnose, problems } from './problems.js';

const POLL_MS = 20;

// If a lidar that has answered before does not answer these queries, it is started anyway.
const DISPENSABLE = new Set(['health', 'frequency']);

// The driver's clock. While the browser does not run the page (a dialog, a sleeping computer), bytes wait and the lidar
// is not silent: so a long pause counts as a short one.
class Clock {
    static #LONGEST_STEP_MS = 100;
    #ms = 0;
    #last = performance.now();

    now() {
        const time = performance.now();
        this.#ms += Math.min(time - this.#last, Clock.#LONGEST_STEP_MS);
        this.#last = time;
        return Math.floor(this.#ms);
    }
}

// Calls these functions of `listener`: onEvent(name, detail), onScan(), onChange(), onBytes(bytes), onProblem(problem
// or null).
export class Lidar {
    info = null;   // The lidar's answers; null: none yet.
    health = null;
    frequencyChz = 0;
    gone = false;
    #library;
    #listener;
    #source;
    #clock;
    #timer = 0;
    #queue = [];
    #command = null;
    #awaitingEnd = null;

    constructor(library, source, listener) {
        this.#library = library;
        this.#source = source;
        this.#listener = listener;
        this.#clock = source.now ? source : new Clock();
    }

    get source() {
        return this.#source;
    }

    // Opens the source; asks the lidar for its information and health, and starts it.
    async open() {
        const source = this.#source;
        source.onBytes = (bytes) => this.#receive(bytes);
        source.onLostBytes = (why) => this.#lostBytes(why);
        source.onGone = () => this.#left();
        source.onBack = () => this.#back();
        this.#library.call('lidar_init', this.#clock.now(), source.listensOnly ? 1 : 0);
        await source.open();
        this.#timer = setInterval(() => this.#tick(), POLL_MS);
        this.#run(source.listensOnly ? ['start'] : ['info', 'health', 'frequency', 'start']);
    }

    // Stops the lidar and closes the source. The lidar has a second to stop.
    async close() {
        if (!this.gone && this.state !== this.#library.constants.STATE_IDLE) {
            this.#queue = [];
            this.#run(['stop']);
            await this.#ended(1000);
        }
        clearInterval(this.#timer);
        await this.#source.close();
    }

    // The page is being closed: only sends the stop command.
    abandon() {
        this.#library.call('lidar_stop');
        this.#send();
    }

    get state() {
        return this.#library.call('lidar_state');
    }

    get isScanning() {
        const { STATE_STARTING, STATE_SCANNING, STATE_RECOVERING } = this.#library.constants;
        return [STATE_STARTING, STATE_SCANNING, STATE_RECOVERING].includes(this.state);
    }

    get isBusy() {
        return this.#command !== null || this.#queue.length > 0;
    }

    // A command of the user: info, health, frequency, reboot, start, stop. A scanning lidar accepts only stop, so for
    // the others it is stopped first and started again afterwards.
    request(command, value) {
        const pause = this.isScanning && command !== 'stop' && command !== 'start';
        this.#run(pause ? ['stop', [command, value], 'start'] : [[command, value]]);
    }

    #run(commands) {
        this.#queue = commands.map((command) => (Array.isArray(command) ? command : [command]));
        this.#next();
    }

    #next() {
        const next = this.#queue.shift();
        this.#command = null;
        if (next === undefined) {
            this.#awaitingEnd?.();
            return;
        }
        const [command, value] = next;
        const status = this.#issue(command, value);
        if (status === this.#library.constants.OK) {
            this.#command = command;
            this.#send();
        } else {
            this.#queue = [];
            this.#listener.onEvent(`${command}: ${this.#library.text('status_name', status)}`);
        }
        this.#listener.onChange();
    }

    #issue(command, value) {
        if (command === 'frequency' && value !== undefined) {
            return this.#library.call('lidar_set_frequency', value);
        }
        return this.#library.call(`lidar_${command}`);
    }

    #ended(limitMs) {
        return new Promise((resolve) => {
            this.#awaitingEnd = resolve;
            setTimeout(resolve, limitMs);
        });
    }

    #tick() {
        this.#source.tick?.(this.#clock.now());
        this.#poll();
    }

    // A block may be larger than the library takes at once.
    #receive(bytes) {
        const size = this.#library.transferSize;
        this.#listener.onBytes(bytes, this.#source.now?.());
        for (let from = 0; from < bytes.length; from += size) {
            const part = bytes.subarray(from, from + size);
            this.#library.hand(part);
            this.#library.call('lidar_feed', part.length);
            this.#poll();
        }
    }

    // Reads the clock for each poll, so that time never runs backwards.
    #poll() {
        const { EVENT_NONE } = this.#library.constants;
        const now = this.#clock.now();
        for (let event; (event = this.#library.call('lidar_poll', now)) !== EVENT_NONE;) {
            this.#take(event);
        }
        this.#send();
    }

    #send() {
        const count = this.#library.call('lidar_sent');
        if (count > 0) {
            this.#source.write(this.#library.take(count));
        }
    }

    #take(event) {
        const c = this.#library.constants;
        if (event === c.EVENT_MORE) {
            return;
        }
        if (event === c.EVENT_SCAN) {
            this.#listener.onScan();
            return;
        }
        const detail = this.#detail(event);
        this.#listener.onEvent(this.#library.text('event_name', event), detail);
        if (event === c.EVENT_COMMAND_FAILED) {
            this.#failed();
        } else if ([c.EVENT_STARTED, c.EVENT_STOPPED, c.EVENT_INFO, c.EVENT_HEALTH, c.EVENT_FREQUENCY,
                    c.EVENT_REBOOTED].includes(event)) {
            this.#listener.onProblem(null);
            this.#next();
        } else if (event === c.EVENT_LOST) {
            this.#lost();
        } else if (event === c.EVENT_RECOVERED) {
            this.#listener.onProblem(null);
        }
        this.#listener.onChange();
    }

    // The details of an event; answers are also stored.
    #detail(event) {
        const c = this.#library.constants;
        switch (event) {
        case c.EVENT_INFO:
            this.info = { ...this.#library.numbers('lidar_info_numbers'), serial: this.#library.takeText() };
            return `model ${this.info.model}, serial number ${this.info.serial}`;
        case c.EVENT_HEALTH:
            this.health = this.#library.numbers('lidar_health_numbers');
            return this.#library.faultsText(this.health.faults);
        case c.EVENT_FREQUENCY:
            this.frequencyChz = this.#library.call('lidar_frequency_chz');
            return `${(this.frequencyChz / 100).toFixed(2)} Hz`;
        case c.EVENT_FAULTS_CHANGED:
            return this.#library.faultsText(this.#library.call('lidar_faults'));
        case c.EVENT_COMMAND_FAILED:
            return this.#library.text('status_name', this.#library.call('lidar_error'));
        default:
            return '';
        }
    }

    // A command that a stop has ended is no failure.
    #failed() {
        const error = this.#library.call('lidar_error');
        if (error === this.#library.constants.ERROR_ABORTED) {
            return;
        }
        const why = this.#library.text('status_name', error);
        const command = this.#command ?? 'command';
        if (DISPENSABLE.has(command) && this.#queue.length > 0 && !this.gone) {
            this.#next();
            return;
        }
        this.#queue = [];
        this.#command = null;
        this.#awaitingEnd?.();
        if (!this.gone) {
            this.#listener.onProblem(this.#source.silent ??
                diagnose(this.#library.numbers('lidar_numbers'), command, why));
        }
    }

    // Reports silence. If bytes still come, reports that none of them are valid packets.
    #lost() {
        if (this.gone) {
            return;
        }
        const before = this.#library.numbers('lidar_numbers').bytes;
        this.#listener.onProblem(this.#source.silent ?? problems.fellSilent);
        setTimeout(() => {
            const { STATE_RECOVERING } = this.#library.constants;
            const now = this.#library.numbers('lidar_numbers').bytes;
            if (!this.gone && this.state === STATE_RECOVERING && now > before) {
                this.#listener.onProblem(problems.garbled);
            }
        }, 300);
    }

    #lostBytes(why) {
        this.#library.call('lidar_gap');
        this.#listener.onEvent('bytes lost before they reached the page', why);
    }

    #left() {
        this.gone = true;
        this.#listener.onProblem(this.#source.lost ?? problems.unplugged);
        this.#listener.onEvent('unplugged', this.#source.name);
        this.#listener.onChange();
    }

    // The driver itself recovers a lidar that was scanning.
    #back() {
        this.gone = false;
        this.#listener.onProblem(null);
        this.#listener.onEvent('plugged in again', this.#source.name);
        this.#listener.onChange();
    }
}
