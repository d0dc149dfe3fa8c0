// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// Switches for the simulated lidar's faults: of the lidar, of its health, of the wire.

import { SimulatedSource } from './simulation.js';
import { element } from './panels.js';

const place = () => element('faults-of-simulation');

function offer(id, text, change) {
    const label = document.createElement('label');
    const box = document.createElement('input');
    box.type = 'checkbox';
    box.id = `sim-${id}`;
    box.addEventListener('change', () => change(box.checked));
    label.append(box, ` ${text}`);
    place().append(label);
}

function offerHealth(library, simulated) {
    const bits = library.faultBits();
    const isChosen = ({ bit }) => element(`sim-health-${bit}`).checked;
    for (const { bit, name } of bits) {
        offer(`health-${bit}`, `health: ${name}`, () => {
            simulated().setHealth(bits.filter(isChosen).reduce((sum, one) => sum + one.bit, 0));
        });
    }
}

// `simulated` returns the simulated lidar that is connected when a switch is used.
export function offerSwitches(library, simulated) {
    offer('blocked', 'rotor blocked', (on) => simulated().set('blocked', on));
    offer('covered', 'window covered', (on) => simulated().set('covered', on));
    offer('visitor', 'someone in front of it', (on) => simulated().set('visitor', on));
    offer('unplugged', 'no power', (on) => simulated().set('unplugged', on));
    offerHealth(library, simulated);
    new SimulatedSource(library).wireFaults.forEach((name, kind) => {
        if (name !== 'unplug') { // "no power" does the same.
            offer(`wire-${name}`, `wire: ${name}`, (on) => simulated().setWireFault(kind, on));
        }
    });
}

export function resetSwitches() {
    for (const box of place().querySelectorAll('input')) {
        box.checked = false;
    }
}
