// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// What can be wrong with the connection, and what to do: the tool's messages, for users of a browser.

const SUPPLY = 'If it happens when the motor starts, give the lidar a supply of its own (5 V, up to 1 A).';

export const problems = {
    noWebSerial: {
        title: 'This browser cannot reach a serial port.',
        advice: ['Open this page in Chrome, Edge or Opera on a computer: they have Web Serial. ' +
                 'Firefox, Safari and most phones do not.',
                 'If the page comes from a server, its address must begin with https: or be localhost; ' +
                 'a file on your disk is fine.',
                 'Recordings and the simulated lidar work here too.'],
    },
    inUse: {
        title: 'The port cannot be opened: another program or tab is using it.',
        advice: ['Close that program (a serial monitor, an IDE, another tab with this page), then connect again.',
                 'On Linux you may also lack the right to open it: join the group dialout and log in again.'],
    },
    noBaudRate: {
        title: 'This adapter cannot do 230400 baud, the lidar’s only baud rate.',
        advice: ['Use an adapter that can, for example one with CP2102, CH340 or FT232.'],
    },
    forbidden: {
        title: 'The browser does not let this page use serial ports.',
        advice: ['Allow serial ports in the browser’s site settings, or open the page outside of a frame.'],
    },
    unplugged: {
        title: 'The adapter has gone: it was unplugged, or has lost its supply.',
        advice: ['Plug it in again: the page goes on by itself. Otherwise press Connect.', SUPPLY],
    },
    lineError: {
        title: 'The serial port failed.',
        advice: ['Press Connect to open it again. If that does not help, plug the adapter out and in.'],
    },
    silence: {
        title: 'No answer: not one byte came.',
        advice: ['Is this the port that the lidar is on?',
                 'Has the lidar 5 V and GND?',
                 'Does its TX go to the adapter’s RX, and its RX to the adapter’s TX?'],
    },
    noise: {
        title: 'Bytes come, but nothing that a T-mini Plus sends: a wrong baud rate, or another device.',
        advice: ['Is it this lidar, and not another device?',
                 'Does the adapter really run at 230400 baud? Try another one.',
                 'Do lidar and adapter share GND, and are the wires short?'],
    },
    deafness: {
        title: 'The lidar sends, but does not do what it is asked.',
        advice: ['Check the wire from the adapter’s TX to the lidar’s RX, and that its level is 3.3 V.'],
    },
    fellSilent: {
        title: 'The lidar has fallen silent; it is being started again.',
        advice: ['Check its plug and its supply (5 V, up to 1 A).'],
    },
    garbled: {
        title: 'Bytes come, but no valid packets any more; the lidar is being started again.',
        advice: ['A wrong baud rate, a bad contact or a weak supply garbles what comes.',
                 'Do lidar and adapter share GND, and are the wires short?'],
    },
    linkLost: {
        title: 'The connection to the lidar’s server is lost.',
        advice: ['The page goes on by itself when it is back. Is the server switched on and in reach?'],
    },
    silentThere: {
        title: 'Nothing comes from the lidar yet.',
        advice: ['It may still be starting.', 'Has the lidar 5 V, and is it connected to the server of this page?'],
    },
    noScans: {
        title: 'The lidar sends packets, but completes no revolution.',
        advice: ['Does it turn?'],
    },
};

// The lidar has answered before, but a command failed.
export function commandFailed(command, why) {
    return {
        title: `The lidar has answered before, but now “${command}” failed: ${why}.`,
        advice: ['Try again. If that does not help, reboot the lidar or cut its supply for a moment.'],
    };
}

// Why no lidar was found, judged by the bytes received.
export function diagnose(numbers, command, why) {
    if (numbers.bytes === 0) {
        return problems.silence;
    }
    if (numbers.packets === 0 && numbers.bytesInReplies === 0) {
        return problems.noise;
    }
    return numbers.bytesInReplies === 0 ? problems.deafness : commandFailed(command, why);
}

// The errors of Web Serial's requestPort() and open(), according to the specification.
export function explainOpening(error) {
    switch (error.name) {
    case 'NotFoundError':
        return null; // The user has chosen no port: no problem.
    case 'SecurityError':
        return problems.forbidden;
    case 'NetworkError':
    case 'InvalidStateError':
        return problems.inUse;
    case 'TypeError':
    case 'NotSupportedError':
        return problems.noBaudRate;
    default:
        return { title: `The port cannot be opened: ${error.message}`, advice: problems.lineError.advice };
    }
}

export const recordingProblems = {
    empty: (name) => ({ title: `${name} is empty: nothing was recorded.`, advice: ['Was the lidar scanning?'] }),
    none: (name, bytes) => ({
        title: `${name} holds no lidar packet in ${bytes} bytes.`,
        advice: ['It is not a recording of a T-mini Plus, or was recorded with another baud rate than 230400, ' +
                 'or before the lidar scanned.'],
    }),
    noScan: (name, packets) => ({
        title: `${name} holds ${packets} packets, but no whole revolution: there is nothing to draw.`,
        advice: ['Its points can be saved as CSV.'],
    }),
    damaged: (name, places) => ({
        title: `${name} is damaged in ${places} place${places === 1 ? '' : 's'}: bytes are missing or wrong there.`,
        advice: ['The rest is shown.'],
    }),
    tooNew: (name, version) => ({
        title: `${name} is of version ${version}: this page is too old for it.`, advice: [],
    }),
    unreadable: (name, why) => ({ title: `${name} cannot be read: ${why}`, advice: [] }),
};

// Possible causes of a reported fault, by the fault's name in the library.
export const faultAdvice = {
    encoder: 'Is the rotor blocked?',
    data: 'Is the window covered?',
};
