// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// Stands in for what the page uses of navigator.serial, as Web Serial specifies it, with the simulated
// lidar at the adapter. It runs before the page and makes its own instance of the library that the page contains.
// Tests control the adapter by `bench`:
//
//     bench.plug()  bench.unplug()         the cable
//     bench.choice = 'none'                the user closes the list of ports
//     bench.opening = 'NetworkError'       open() fails with this error
//     bench.line = 'good' | 'dead' | 'garbled' | 'deaf' |
//                 'held' (bytes come when it is good again) |
//                 'late' (bytes come only every second time)
//     bench.lineError('ParityError')       the stream ends with this error, the port stays open
//     bench.writeError()                   the next write fails, the port stays open
//     bench.answers = (code) => …          whether the lidar receives this command

const bench = { choice: 'port', opening: null, line: 'good', opened: [], written: [], answers: () => true };

const PORTION = 64; // Bytes per USB packet.

class Device {
    #exports = null;
    #plugged = true;
    #turn = 0;

    async #power() {
        const text = document.getElementById('library').textContent.trim();
        const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
        this.#exports = (await WebAssembly.instantiate(bytes)).instance.exports;
        this.#exports.simulation_init(7, 1, 600);
    }

    get #now() {
        return Math.floor(performance.now());
    }

    async ready() {
        if (this.#exports === null) {
            await this.#power();
        }
    }

    setPower(on) {
        this.#plugged = on;
        this.#exports?.simulation_power(on ? 1 : 0, this.#now);
    }

    receive(bytes) {
        if (!this.#plugged || bench.line === 'deaf' || !bench.answers(bytes[1])) {
            return;
        }
        new Uint8Array(this.#exports.memory.buffer, this.#exports.transfer(), bytes.length).set(bytes);
        this.#exports.simulation_write(bytes.length, this.#now);
    }

    // The bytes that have come since the last call; bytes that the caller does not take are lost.
    send() {
        this.#turn++;
        if (bench.line === 'held' || (bench.line === 'late' && this.#turn % 2 === 0)) {
            return new Uint8Array(0);
        }
        const count = this.#exports.simulation_read(this.#now);
        const bytes = new Uint8Array(this.#exports.memory.buffer, this.#exports.transfer(), count).slice();
        if (bench.line === 'dead') {
            return bytes.subarray(0, 0);
        }
        return bench.line === 'garbled' ? bytes.map((byte) => (byte * 7 + 90) & 0x7F) : bytes;
    }

    // Behaves as a lidar that was left scanning.
    startByItself() {
        this.receive(Uint8Array.of(0xA5, 0x60));
    }
}

// [[state]], [[readFatal]] … are the specification's internal slots.
class StandInPort extends EventTarget {
    #state = 'closed';
    #readable = null;
    #writable = null;
    #fatal = false; // [[readFatal]] and [[writeFatal]]: here both come only from a loss.
    #bufferSize = 0;
    #control = null;
    #writeControl = null;
    #timer = 0;
    #connected = true;
    #failsWriting = false;
    #device;

    constructor(device) {
        super();
        this.#device = device;
    }

    get connected() {
        return this.#connected;
    }

    getInfo() {
        return { usbVendorId: 0x10C4, usbProductId: 0xEA60 };
    }

    async open(options) {
        if (options?.baudRate === undefined) {
            throw new TypeError('required member baudRate is undefined.');
        }
        if (this.#state !== 'closed') {
            throw new DOMException('The port is already open.', 'InvalidStateError');
        }
        if (options.baudRate === 0 || options.bufferSize === 0) {
            throw new TypeError('A value is 0.');
        }
        this.#state = 'opening';
        await this.#device.ready();
        if (bench.opening !== null || !this.#connected) {
            this.#state = 'closed';
            throw new DOMException('Failed to open serial port.', bench.opening ?? 'NetworkError');
        }
        bench.opened.push({ ...options });
        this.#state = 'opened';
        this.#bufferSize = options.bufferSize ?? 255;
        this.#fatal = false;
        this.#timer = setInterval(() => this.#arrive(), 8);
    }

    get readable() {
        if (this.#readable === null && this.#state === 'opened' && !this.#fatal) {
            this.#readable = new ReadableStream({
                type: 'bytes',
                start: (control) => { this.#control = control; },
                cancel: () => { this.#readable = null; },
            }, { highWaterMark: this.#bufferSize });
        }
        return this.#readable;
    }

    get writable() {
        if (this.#writable === null && this.#state === 'opened' && !this.#fatal) {
            this.#writable = new WritableStream({
                start: (control) => { this.#writeControl = control; },
                write: (bytes) => {
                    if (this.#failsWriting) {
                        this.#failsWriting = false;
                        this.#writable = null;
                        throw new DOMException('Writing failed.', 'UnknownError');
                    }
                    bench.written.push(...bytes);
                    this.#device.receive(bytes);
                },
                abort: () => { this.#writable = null; },
                close: () => { this.#writable = null; },
            });
        }
        return this.#writable;
    }

    // Fails if a stream is locked, because cancel() and abort() then fail.
    async close() {
        if (this.#state !== 'opened') {
            throw new DOMException('The port is already closed.', 'InvalidStateError');
        }
        const ends = [this.#readable?.cancel(), this.#writable?.abort()];
        this.#state = 'closing';
        try {
            await Promise.all(ends);
        } catch (error) {
            this.#state = 'opened';
            throw error;
        }
        clearInterval(this.#timer);
        this.#readable = null;
        this.#writable = null;
        this.#state = 'closed';
    }

    // Puts the bytes that have come into the stream; if its buffer is too small, the stream fails.
    #arrive() {
        const bytes = this.#device.send();
        if (bytes.length === 0 || this.#readable === null) {
            return;
        }
        if (this.#control.desiredSize < bytes.length) {
            this.failStream('BufferOverrunError');
            return;
        }
        for (let from = 0; from < bytes.length; from += PORTION) {
            this.#control.enqueue(bytes.slice(from, from + PORTION));
        }
    }

    // The stream ends with an error, the port stays open.
    failStream(name) {
        this.#control.error(new DOMException(`The line failed: ${name}.`, name));
        this.#readable = null;
    }

    failWriting() {
        this.#failsWriting = true;
    }

    lose() {
        const lost = () => new DOMException('The device has been lost.', 'NetworkError');
        this.#connected = false;
        clearInterval(this.#timer);
        if (this.#state === 'opened') {
            this.#fatal = true;
            if (this.#readable !== null) {
                this.#control.error(lost());
                this.#readable = null;
            }
            if (this.#writable !== null) {
                this.#writeControl.error(lost());
                this.#writable = null;
            }
        }
        this.#dispatch('disconnect');
    }

    find() {
        this.#connected = true;
        this.#dispatch('connect');
    }

    // Dispatches an event at the port, and at navigator.serial as if it had bubbled.
    #dispatch(type) {
        this.dispatchEvent(new Event(type));
        const event = new Event(type);
        Object.defineProperty(event, 'target', { value: this });
        navigator.serial.dispatchEvent(event);
    }
}

class StandInSerial extends EventTarget {
    #port;

    constructor(port) {
        super();
        this.#port = port;
    }

    async getPorts() {
        return this.#port.connected ? [this.#port] : [];
    }

    async requestPort() {
        if (!navigator.userActivation.isActive) {
            throw new DOMException('Must be handling a user gesture to show a permission request.', 'SecurityError');
        }
        if (bench.choice === 'none') {
            throw new DOMException('No port selected by the user.', 'NotFoundError');
        }
        return this.#port;
    }
}

{
    const device = new Device();
    const port = new StandInPort(device);
    bench.unplug = () => {
        device.setPower(false);
        port.lose();
    };
    bench.plug = () => {
        device.setPower(true);
        port.find();
    };
    bench.lineError = (name) => port.failStream(name);
    bench.writeError = () => port.failWriting();
    bench.leaveScanning = async () => {
        await device.ready();
        device.startByItself();
    };
    bench.port = port;
    window.bench = bench;
    Object.defineProperty(navigator, 'serial', { value: new StandInSerial(port), configurable: true });
}
