// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// A lidar on a port that the user chooses: Web Serial as the source of bytes.

const BAUD_RATE = 230400;
const BUFFER_SIZE = 16384; // More than a second of data, for a page that is busy.

// These end a stream, but not the port: it goes on with a new stream (Web Serial, "readable").
const PASSING = new Set(['BufferOverrunError', 'FramingError', 'ParityError', 'BreakError']);

export function hasWebSerial() {
    return 'serial' in navigator;
}

// USB's numbers of vendor and product are all that a page gets to know of an adapter.
function nameOf(port) {
    const { usbVendorId, usbProductId } = port.getInfo();
    const hex = (number) => number.toString(16).padStart(4, '0');
    return usbVendorId === undefined ? 'serial port' : `USB adapter ${hex(usbVendorId)}:${hex(usbProductId)}`;
}

export class SerialSource {
    kind = 'serial';
    onBytes = () => {};
    onLostBytes = () => {}; // The computer, or the line, has lost some.
    onGone = () => {};
    onBack = () => {};
    #port;
    #writer = null;
    #reader = null;
    #reading = null;
    #closing = false;
    #listeners = new AbortController();

    // Asks the user for a port. Fails with an error of Web Serial's.
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

    // The reading side reports it if the port is gone. If it is not, it has a new stream to write to.
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

    // A port can only be closed once its streams are released.
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

    // Until the stream ends: null, or why it failed.
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
            this.#reader.releaseLock();
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

    // The stream reports it as well, but only if something is being read.
    #left(port) {
        if (port === this.#port) {
            this.#fail();
        }
    }

    // Chrome may make a new port of the same adapter.
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
            this.onGone(); // Not ready yet; another event, or the user, will try again.
        }
    }
}
