// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// Stands in for what the page uses of navigator.serial, as Web Serial specifies it, with the simulated
// lidar at the adapter. It runs before the page and makes its own instance of the library that the page contains.
// Tests control the adapter by `bench`:
//
//     bench.plug()  bench.unplug()         the cable
//     bench.plugAnother(0xEA60)            another port, of an adapter with this product number
//     bench.opened                         the product numbers of the ports whose open() was called
//     bench.choice = 'none'                the user closes the list of ports
//     bench.opening = 'NetworkError'       open() fails with this error
//     bench.line = 'good' | 'garbled' | 'held' (bytes come when it is good again) |
//                 'late' (bytes come only every second time)
//     bench.lineError('ParityError')       the stream ends with this error, the port stays open
//     bench.writeError()                   the next write fails, the port stays open
//     bench.answers = (code) => …          whether the lidar receives this command

const bench = {
    choice: 'port', opening: null, line: 'good', baudRate: 0, written: [], opened: [], answers: () => true,
};

const PORTION = 64; // Bytes per USB packet.

class Device {
    #library = null;
    #plugged = true;
    #turn = 0;

    // The library is that of the page, which must be there.
    async ready() {
        if (this.#library === null) {
            const text = document.getElementById('library').textContent.trim();
            const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
            this.#library = (await WebAssembly.instantiate(bytes)).instance.exports;
            this.#library.simulation_init(7, 1, 600);
        }
    }

    #transferred(count) {
        return new Uint8Array(this.#library.memory.buffer, this.#library.transfer(), count);
    }

    setPower(on) {
        this.#plugged = on;
        this.#library?.simulation_power(on, performance.now());
    }

    receive(bytes) {
        if (this.#plugged && bench.answers(bytes[1])) {
            this.#transferred(bytes.length).set(bytes);
            this.#library.simulation_write(bytes.length, performance.now());
        }
    }

    // The bytes that have come since the last call; bytes that the caller does not take are lost.
    send() {
        this.#turn++;
        if (bench.line === 'held' || (bench.line === 'late' && this.#turn % 2 === 0)) {
            return new Uint8Array(0);
        }
        const bytes = this.#transferred(this.#library.simulation_read(performance.now())).slice();
        return bench.line === 'garbled' ? bytes.map((byte) => (byte * 7 + 90) & 0x7F) : bytes;
    }
}

// [[state]], [[readFatal]] … are the specification's internal slots. Whatever is not private here is in the
// specification: test_sources.py compares it with the browser's own.
class StandInPort extends EventTarget {
    #state = 'closed';
    #readable = null;
    #writable = null;
    #fatal = false; // [[readFatal]] and [[writeFatal]]: here both come only from a loss.
    #bufferSize = 0;
    #control = null;
    #writeControl = null;
    #timer = 0;
    #present = true;
    #failsWriting = false;
    #device = new Device();
    #product;

    constructor(product) {
        super();
        this.#product = product;
    }

    getInfo() {
        return { usbVendorId: 0x10C4, usbProductId: this.#product };
    }

    async open({ baudRate, bufferSize = 255 }) {
        bench.opened.push(this.#product);
        if (this.#state !== 'closed') {
            throw new DOMException('The port is already open.', 'InvalidStateError');
        }
        this.#state = 'opening';
        await this.#device.ready();
        if (bench.opening !== null || !this.#present) {
            this.#state = 'closed';
            throw new DOMException('Failed to open serial port.', bench.opening ?? 'NetworkError');
        }
        bench.baudRate = baudRate;
        this.#state = 'opened';
        this.#bufferSize = bufferSize;
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
        const end = () => { this.#writable = null; };
        if (this.#writable === null && this.#state === 'opened' && !this.#fatal) {
            this.#writable = new WritableStream({
                start: (control) => { this.#writeControl = control; },
                write: (bytes) => {
                    if (this.#failsWriting) {
                        this.#failsWriting = false;
                        end();
                        throw new DOMException('Writing failed.', 'UnknownError');
                    }
                    bench.written.push(...bytes);
                    this.#device.receive(bytes);
                },
                abort: end,
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
        this.#state = 'closed';
    }

    // Puts the bytes that have come into the stream; if its buffer is too small, the stream fails.
    #arrive() {
        const bytes = this.#device.send();
        if (bytes.length === 0 || this.#readable === null) {
            return;
        }
        if (this.#control.desiredSize < bytes.length) {
            this.#failStream('BufferOverrunError');
            return;
        }
        for (let from = 0; from < bytes.length; from += PORTION) {
            this.#control.enqueue(bytes.slice(from, from + PORTION));
        }
    }

    // The stream ends with an error, the port stays open.
    #failStream(name) {
        this.#control.error(new DOMException(`The line failed: ${name}.`, name));
        this.#readable = null;
    }

    #lose() {
        clearInterval(this.#timer);
        if (this.#state === 'opened') {
            const lost = new DOMException('The device has been lost.', 'NetworkError');
            this.#fatal = true;
            this.#control?.error(lost);
            this.#writeControl?.error(lost);
            this.#readable = null;
            this.#writable = null;
        }
    }

    #setPower(on) {
        this.#present = on;
        this.#device.setPower(on);
        if (!on) {
            this.#lose();
        }
        const event = new Event(on ? 'connect' : 'disconnect');
        Object.defineProperty(event, 'target', { value: this }); // As if it had bubbled from the port.
        navigator.serial.dispatchEvent(event);
    }

    static {
        const port = new StandInPort(0xEA60);
        bench.port = port;
        bench.plug = () => port.#setPower(true);
        bench.unplug = () => port.#setPower(false);
        bench.plugAnother = (product) => new StandInPort(product).#setPower(true);
        bench.lineError = (name) => port.#failStream(name);
        bench.writeError = () => { port.#failsWriting = true; };
        bench.leaveScanning = async () => { // As another program may have left it.
            await port.#device.ready();
            port.#device.receive(Uint8Array.of(0xA5, 0x60));
        };
    }
}

class StandInSerial extends EventTarget {
    async requestPort() {
        if (!navigator.userActivation.isActive) {
            throw new DOMException('Must be handling a user gesture to show a permission request.', 'SecurityError');
        }
        if (bench.choice === 'none') {
            throw new DOMException('No port selected by the user.', 'NotFoundError');
        }
        return bench.port;
    }
}

window.bench = bench;
Object.defineProperty(navigator, 'serial', { value: new StandInSerial(), configurable: true });
