// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// A source of bytes: the lidar of the server that this page comes from, as a timed stream over a WebSocket. It only
// listens.

import { problems } from './problems.js';

const RETRY_MS = 1000;

// Such a server has the page at this path.
export const isServed = () => location.protocol.startsWith('http') && location.pathname === '/live';

export class NetworkSource {
    kind = 'network';
    name = `lidar at ${location.host}`;
    listensOnly = true;
    silent = problems.silentThere;
    lost = problems.linkLost;
    #library;
    #socket = null;
    #isClosed = false;
    #isGone = false;

    constructor(library) {
        this.#library = library;
    }

    async open() {
        this.#connect();
    }

    async close() {
        this.#isClosed = true;
        this.#socket.close();
    }

    write() {}

    // When the bytes that are being handed over came.
    now() {
        return this.#library.call('network_now_ms', performance.now() * 1000);
    }

    #connect() {
        this.#library.call('network_begin');
        this.#socket = new WebSocket(`${location.protocol.replace('http', 'ws')}//${location.host}/stream`);
        this.#socket.binaryType = 'arraybuffer';
        this.#socket.onmessage = ({ data }) => this.#receive(new Uint8Array(data));
        this.#socket.onclose = () => this.#left();
    }

    #receive(bytes) {
        const { transferSize, constants } = this.#library;
        if (this.#isGone) {
            this.#isGone = false;
            this.onBack();
        }
        for (let at = 0; at < bytes.length;) {
            const part = bytes.subarray(at, at + transferSize);
            this.#library.hand(part);
            at += this.#library.call('network_put', part.length);
            for (let count; (count = this.#library.call('network_take', performance.now() * 1000)) > 0;) {
                if (count === constants.NETWORK_GAP) {
                    this.onLostBytes('the network is too slow');
                } else {
                    this.onBytes(this.#library.take(count));
                }
            }
        }
    }

    #left() {
        if (this.#isClosed) {
            return;
        }
        if (!this.#isGone) {
            this.#isGone = true;
            this.onLostBytes('the connection is lost');
            this.onGone();
        }
        setTimeout(() => this.#isClosed || this.#connect(), RETRY_MS);
    }
}
