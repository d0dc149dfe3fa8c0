// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// A source of bytes: the simulated lidar of the library's tests, in the page.

export class SimulatedSource {
    kind = 'simulation';
    name = 'simulated lidar';
    onBytes = () => {};
    #library;
    #nowMs = 0;

    constructor(library) {
        this.#library = library;
    }

    async open() {
        this.#library.call('simulation_init', 1, 1, 600);
    }

    async close() {}

    write(bytes) {
        this.#library.hand(bytes);
        this.#library.call('simulation_write', bytes.length, this.#nowMs);
    }

    // Time passes: hands over what the lidar has sent until now.
    tick(nowMs) {
        this.#nowMs = nowMs;
        let count;
        do {
            count = this.#library.call('simulation_read', nowMs);
            if (count > 0) {
                this.onBytes(this.#library.take(count));
            }
        } while (count === this.#library.transferSize);
    }

    // The names of the wire's faults, in the order of their numbers.
    get wireFaults() {
        const names = [];
        for (let name; (name = this.#library.text('simulation_fault_name', names.length)) !== null;) {
            names.push(name);
        }
        return names;
    }

    setWireFault(kind, on) {
        this.#library.call('simulation_fault', kind, on ? 1 : 0, this.#nowMs);
    }

    setHealth(bits) {
        this.#library.call('simulation_health', bits);
    }

    // Switches other faults on or off.
    set(what, on) {
        const value = on ? 1 : 0;
        switch (what) {
        case 'blocked': return this.#library.call('simulation_block', value);
        case 'covered': return this.#library.call('simulation_cover', value);
        case 'visitor': return this.#library.call('simulation_visitor', value);
        case 'unplugged': return this.#library.call('simulation_power', 1 - value, this.#nowMs);
        default: return undefined;
        }
    }
}
