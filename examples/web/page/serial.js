// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// A source of bytes: a lidar on a serial port that the user chooses (Web Serial).

const BAUD_RATE = 230400;
const BUFFER_SIZE = 16384; // More than a second of data, because the page may be busy.

// These errors end a stream, but the port continues with a new stream (Web Serial, "readable").
const PASSING = new Set(['BufferOverrunError', 'FramingError', 'ParityError', 'BreakError']);

export function hasWebSerial() {
    return 'serial' in navigator;
}

// A page can read only an adapter's USB vendor and product numbers.
function nameOf(port) {
    const { usbVendorId, usbProductId } = port.getInfo();
    const hex = (number) => number.toString(16).padStart(4, '0');
    return usbVendorId === undefined ? 'serial port' : `USB adapter ${hex(usbVendorId)}:${hex(usbProductId)}`;
}

export class SerialSource {
    kind = 'serial';
    onBytes = () => {};
    onLostBytes = () => {}; // The computer, or the line, has lost bytes.
    onGone = () => {};
    onBack = () => {};
    #port;
    #writer = null;
    #reader = null;
    #reading = null;
    #closing = false;
    #listeners = new AbortController();

    // Asks the user for a port. Fails with an error of Web Serial.
    static async choose() {
        return new SerialSource(await navigator.serial.requestPort());
    }

    constructor(port) {
        this.#port = port;
        this.name = nameOf(port);
    }

    async open() {
        const options = { signal: this.#listeners.signal };
        await this.#start();
        navigator.serial.addEventListener('disconnect', (event) => this.#left(event.target), options);
        navigator.serial.addEventListener('connect', (event) => this.#returned(event.target), options);
    }

    // If the port has gone, the reading side reports it. Otherwise the port has a new stream to write to.
    write(bytes) {
        const writer = this.#writer;
        writer?.write(bytes).catch(() => {
            if (this.#writer === writer && this.#port.writable !== null) {
                writer.releaseLock();
                this.#writer = this.#port.writable.getWriter();
            }
        });
    }

    async close() {
        this.#closing = true;
        this.#listeners.abort();
        await this.#shut();
    }

    async #start() {
        await this.#port.open({ baudRate: BAUD_RATE, bufferSize: BUFFER_SIZE });
        this.#writer = this.#port.writable.getWriter();
        this.#reading = this.#read();
    }

    // A port can be closed only after its streams have ended or been released.
    async #shut() {
        await this.#reader?.cancel().catch(() => {});
        await this.#reading;
        if (this.#writer !== null) {
            await this.#writer.abort().catch(() => {});
            this.#writer.releaseLock();
            this.#writer = null;
        }
        await this.#port.close().catch(() => {});
    }

    async #read() {
        while (this.#port.readable !== null && !this.#closing) {
            const error = await this.#readStream();
            if (error === null || !PASSING.has(error.name)) {
                break;
            }
            this.onLostBytes(error.name);
        }
        this.#fail();
    }

    // Reads until the stream ends; returns null, or the error.
    async #readStream() {
        this.#reader = this.#port.readable.getReader();
        try {
            for (;;) {
                const { value, done } = await this.#reader.read();
                if (done) {
                    return null;
                }
                this.onBytes(value);
            }
        } catch (error) {
            return error;
        } finally {
            this.#reader = null;
        }
    }

    #fail() {
        if (this.#writer !== null && !this.#closing) {
            this.#writer.releaseLock();
            this.#writer = null;
            this.onGone();
        }
    }

    // The stream reports this as well, but only during a read.
    #left(port) {
        if (port === this.#port) {
            this.#fail();
        }
    }

    // Chrome may create a new port for the same adapter.
    async #returned(port) {
        if (this.#writer !== null || (port !== this.#port && nameOf(port) !== this.name)) {
            return;
        }
        await this.#reading;
        await this.#port.close().catch(() => {});
        this.#port = port;
        try {
            await this.#start();
            this.onBack();
        } catch {
            this.onGone(); // Not ready yet; another event, or the user, causes the next attempt.
        }
    }
}
