// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The tmini authors

// Words and numbers beside the picture. A text is written only when it has changed, to spare screen readers and the
// browser.

const DIRECTIONS = ['ahead', 'ahead right', 'right', 'behind right', 'behind', 'behind left', 'left', 'ahead left'];
const LOG_LENGTH = 200;

export const element = (id) => document.getElementById(id);

export function setText(id, text) {
    const target = element(id);
    if (target.textContent !== String(text)) {
        target.textContent = text;
    }
}

export function show(id, isShown) {
    element(id).hidden = !isShown;
}

export function enable(ids, isOn) {
    for (const id of ids) {
        element(id).setAttribute('aria-disabled', String(!isOn));
    }
}

export const isEnabled = (target) => target.getAttribute('aria-disabled') !== 'true';

export const metres = (mm) => (mm === 0 ? '–' : `${(mm / 1000).toFixed(3)} m`);
export const degrees = (q6) => (Math.floor(q6 / 6.4) / 10).toFixed(1);
export const hertz = (chz) => (chz === 0 ? '–' : `${(chz / 100).toFixed(2)} Hz`);

function setCount(id, count) {
    setText(id, count ?? '–');
    element(id).classList.toggle('bad', count > 0);
}

function quality(scan, isBlocked) {
    if (isBlocked) {
        return 'none: the rotor is blocked';
    }
    if (scan.valid === 0) {
        return 'none: no point has a distance';
    }
    if (scan.complete) {
        return 'complete';
    }
    return scan.gaps > 0 || scan.dropped > 0
        ? `gaps: ${scan.gaps}, wrong checksums: ${scan.checksumErrors}, points dropped: ${scan.dropped}`
        : 'cut short';
}

function inWords(scan, nearest) {
    return scan.nearestMm > 0 ? `Nearest obstacle: ${nearest}.` : 'No point has a distance.';
}

// The numbers of the scan that is shown; null before the first. A lidar whose rotor is blocked goes on reporting the
// frequency at which it should turn.
export function showScan(scan, sectors, isBlocked) {
    const has = scan !== null && scan.points > 0;
    const turning = isBlocked ? 'Not turning' : hertz(scan?.frequencyChz ?? 0);
    setText('frequency', has && !isBlocked ? turning : '–');
    setText('points', has ? `${scan.points}, ${scan.valid} with a distance` : '–');
    setText('quality', has ? quality(scan, isBlocked) : '–');
    element('quality').classList.toggle('bad', has && scan.valid === 0);
    setText('flagged', has ? scan.flagged : '–');
    const nearest = has && scan.nearestMm > 0
        ? `${metres(scan.nearestMm)} at ${degrees(scan.nearestQ6)}°, ${DIRECTIONS[scan.nearestSector]}`
        : '–';
    setText('nearest', nearest);
    setText('summary', has ? `${turning}, ${scan.points} points. ${inWords(scan, nearest)}` : '');
    DIRECTIONS.forEach((_, i) => setText(`sector${i}`, has ? metres(sectors[i]) : '–'));
}

// The counters; null: there is no source.
export function showCounters(numbers) {
    setText('bytes', numbers?.bytes ?? '–');
    setText('packets', numbers?.packets ?? '–');
    setText('scans', numbers?.scans ?? '–');
    setText('last-crc-bytes', numbers?.lastCrcBytes ?? '–');
    setText('skipped', numbers?.bytesSkipped ?? '–');
    setCount('checksums', numbers?.checksumErrors);
    setCount('overrun', numbers?.bytesOverrun);
    setCount('timeouts', numbers?.timeouts);
    setCount('losses', numbers?.losses);
    setText('recoveries', numbers?.recoveries ?? '–');
}

function ctVersion(numbers, constants) {
    const { KNOWN_FIRMWARE, KNOWN_USER_VERSION } = constants;
    const parts = [];
    if (numbers.known & KNOWN_FIRMWARE) {
        parts.push(`firmware ${numbers.ctFirmwareMajor}.${numbers.ctFirmwareMinor}, hardware ${numbers.ctHardware}`);
    }
    if (numbers.known & KNOWN_USER_VERSION) {
        parts.push(`protocol ${numbers.userMajor}.${numbers.userMinor}`);
    }
    return parts.join(', ') || 'not sent by this unit';
}

function ctSerial(numbers, constants) {
    if (!(numbers.known & constants.KNOWN_SERIAL)) {
        return 'not sent';
    }
    const two = (number) => String(number).padStart(2, '0');
    return `${numbers.year}${two(numbers.month)}${two(numbers.day)}${String(numbers.number).padStart(8, '0')}`;
}

// CT information, from the lidar's or the recording's numbers; null: there is no source.
export function showCt(numbers, constants, faultsText) {
    setText('ct-version', numbers ? ctVersion(numbers, constants) : '–');
    setText('ct-serial', numbers ? ctSerial(numbers, constants) : '–');
    const known = numbers && numbers.known & constants.KNOWN_FAULTS;
    setText('ct-health', known ? faultsText(numbers.ctFaults) : numbers ? 'not sent' : '–');
}

// The lidar's answers to queries; null: not asked yet.
export function showUnit(info, health, constants, faultsText) {
    const models = { [constants.MODEL_T_MINI_PLUS]: 'T-mini Plus', [constants.MODEL_T_MINI_PRO]: 'T-mini Pro' };
    setText('model', info ? `${info.model} ${models[info.model] ?? '(not a T-mini that this page knows)'}` : '–');
    setText('firmware', info ? `${info.firmwareMajor}.${info.firmwareMinor}` : '–');
    setText('hardware', info ? info.hardware : '–');
    setText('serial-number', info ? info.serial : '–');
    setText('health-reply', health ? faultsText(health.faults) : '–');
}

function paragraph(text, className) {
    const target = document.createElement('p');
    target.textContent = text;
    target.className = className;
    return target;
}

// Shows a problem: what happened, and what to do; null removes it. `place`: the element that shows problems of the
// connection, or the element that shows faults of the lidar.
export function showProblem(place, problem) {
    const target = element(place);
    const title = problem?.title ?? '';
    if (target.dataset.title === title) {
        return;
    }
    target.dataset.title = title;
    target.hidden = problem === null;
    const advice = (problem?.advice ?? []).map((text) => paragraph(text, 'advice'));
    target.replaceChildren(...(problem ? [paragraph(title, 'title'), ...advice] : []));
}

export function log(text, detail) {
    const entry = document.createElement('div');
    const time = document.createElement('time');
    time.textContent = new Date().toTimeString().slice(0, 8);
    entry.append(time, ` ${text}${detail ? `: ${detail}` : ''}`);
    const list = element('log');
    list.append(entry);
    if (list.children.length > LOG_LENGTH) {
        list.firstElementChild.remove();
    }
    list.scrollTop = list.scrollHeight;
}
