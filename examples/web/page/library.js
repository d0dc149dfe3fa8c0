// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// Calls the library, which is compiled to WebAssembly, and reads its numbers and texts. Nothing is computed here.

// An object that throws an error when a name is missing.
function strict(numbers) {
    return new Proxy(numbers, {
        get(target, name) {
            if (!(name in target)) {
                throw new ReferenceError(`the library has no ${String(name)}`);
            }
            return target[name];
        },
    });
}

export class Library {
    #exports;
    #memory;
    #names = new Map();

    // `bytes`: the compiled library.
    static async load(bytes) {
        const { instance } = await WebAssembly.instantiate(bytes);
        return new Library(instance.exports);
    }

    constructor(exports) {
        this.#exports = exports;
        this.#memory = exports.memory.buffer; // Never grows: the library has no heap.
        this.constants = strict(this.#table(exports.constants(), Int32Array));
    }

    call(name, ...values) {
        return this.#exports[name](...values);
    }

    // The numbers that a library function puts into the table, as an object.
    numbers(name) {
        return this.#table(this.#exports[name]());
    }

    // A constant text that a library function returns; null for none.
    text(name, ...values) {
        const address = this.#exports[name](...values);
        return address === 0 ? null : this.#string(address);
    }

    // How many bytes can be passed at once.
    get transferSize() {
        return this.#exports.transfer_size();
    }

    hand(bytes) {
        new Uint8Array(this.#memory, this.#exports.transfer(), bytes.length).set(bytes);
    }

    // A copy of the first `count` bytes that the library has passed.
    take(count) {
        return new Uint8Array(this.#memory, this.#exports.transfer(), count).slice();
    }

    // A copy of the bytes at the address that a library function returns.
    bytes(count, name, ...values) {
        return new Uint8Array(this.#memory, this.#exports[name](...values), count).slice();
    }

    // The text that the library has passed.
    takeText() {
        return this.#string(this.#exports.transfer());
    }

    // A copy of the points at the address that a library function returns.
    points(name, count) {
        const address = this.#exports[name]();
        return new Points(this.#memory.slice(address, address + Points.SIZE * count));
    }

    // A copy of 16-bit numbers, in the same way.
    words(name, count) {
        return new Uint16Array(this.#memory, this.#exports[name](), count).slice();
    }

    // All faults that a lidar can report: bit and name.
    faultBits() {
        const bits = [];
        for (let bit = 1; bit <= this.constants.FAULT_MASK; bit *= 2) {
            bits.push({ bit, name: this.text('fault_name', bit) });
        }
        return bits;
    }

    faultNames(faults) {
        return this.faultBits().filter(({ bit }) => faults & bit).map(({ name }) => name);
    }

    // "encoder, data", or "no faults".
    faultsText(faults) {
        this.call('faults_text', faults);
        return faults === 0 ? 'no faults' : this.takeText();
    }

    #string(address) {
        const bytes = new Uint8Array(this.#memory, address);
        return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
    }

    #name(address) {
        if (!this.#names.has(address)) {
            this.#names.set(address, this.#string(address));
        }
        return this.#names.get(address);
    }

    // Pairs of a name's address and a value; only constants can be negative.
    #table(count, Numbers = Uint32Array) {
        const pairs = new Numbers(this.#memory, this.#exports.numbers(), 2 * count);
        const numbers = {};
        for (let i = 0; i < count; i++) {
            numbers[this.#name(pairs[2 * i])] = pairs[2 * i + 1];
        }
        return numbers;
    }
}

// An array of tmini_point_t, six bytes each; wasm/shown.c checks this layout.
export class Points {
    static SIZE = 6;

    constructor(buffer) {
        this.count = buffer.byteLength / Points.SIZE;
        this.words = new Uint16Array(buffer);
        this.bytes = new Uint8Array(buffer);
    }

    angleQ6(i) {
        return this.words[3 * i];
    }

    distanceMm(i) {
        return this.words[3 * i + 1];
    }

    intensity(i) {
        return this.bytes[6 * i + 4];
    }

    flag(i) {
        return this.bytes[6 * i + 5];
    }

    // A point as `tmini` prints it. Six decimals are exact for multiples of 1/64 degree.
    csv(i) {
        const degrees = (this.angleQ6(i) / 64).toFixed(6);
        return `${i},${degrees},${this.distanceMm(i)},${this.intensity(i)},${this.flag(i)}`;
    }
}
