#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Runs the proofs with CBMC, and prints a table. run.sh calls it.

    prove.py --work DIR [--quick] [--broken] [NAME …]

Each proof is a function prove_NAME() in this folder. All its claims must hold, except one that is added: the claim
that its end is not reached must fail, otherwise nothing is proved. With --broken, a copy of the library is first
broken in one place, which the table below names for each proof; then another claim must fail.
"""

import argparse
import re
import resource
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
FOLDERS = ("lib/include", "lib/src", "test/qa/proof", "test/support")

RING = ["tmini_ring.c"]
FRAME = RING + ["tmini_frame.c"]
SCAN = FRAME + ["tmini_packet.c", "tmini_builder.c", "tmini_ct.c"]
USE = SCAN + ["tmini_ranges.c", "tmini_sectors.c", "tmini_mount.c", "tmini_units.c"]
DRIVER = RING + ["tmini_command.c", "tmini_recovery.c", "tmini_monitor.c", "tmini_reply.c", "tmini_line.c",
                 "tmini_decoder.c"]
PARSER_FILES = ["proof_parser.c", "parser_contract.c"]
DRIVER_FILES = ["proof_driver.c", "stubs.c", "parser_contract.c"]

ANY_RING = "ring of 32 bytes, all indices"
EARLY = "ring of 32 bytes"
PARSED = "ring of 32 bytes, DMA 16; bytes come between accesses"
ANY_SCAN = "packets of up to 3 samples, buffer of up to 4 points"
ANY_LIDAR = "ring of 64 bytes; parser, packet, scan, ct by contract"

NOT_REACHED = "the end is not reached"


class Proof:
    """One proof: its sources, the bounds of its loops, and the change that breaks the library."""

    def __init__(self, name, files, sources, unwind, bounds, broken, loops="", stubs=(), cases=((),),
                 function=None, slow=False, inserted=(), replaced=()):
        self.name, self.files, self.sources, self.unwind = name, files, sources, unwind
        self.bounds, self.broken, self.loops, self.stubs = bounds, broken, loops, stubs
        self.cases, self.slow, self.inserted, self.replaced = cases, slow, inserted, replaced
        self.function = "prove_" + (function or name)


def ring(name, *broken):
    return Proof("ring_" + name, ["proof_ring.c"], RING, 37, EARLY if name == "write" else ANY_RING, broken,
                 slow=name == "write")


def parser(name, *broken, unwind=33, bounds=PARSED, **more):
    return Proof("parser_" + name, PARSER_FILES, FRAME, unwind, bounds, broken, **more)


def scan(name, *broken):
    return Proof(name, ["proof_scan.c"], SCAN, 10, ANY_SCAN, broken, loops="fill_memory.0:33",
                 slow=name in ("scan_step", "packet_points"))


def angle(samples, *broken, **more):
    return Proof(f"angle_{samples}", ["proof_angle.c"], FRAME + ["tmini_packet.c"], 4,
                 f"all FSA, LSA; {samples} samples, one at a time", broken, loops="fill_memory.0:33",
                 cases=[[f"SAMPLES={samples}u", f"INDEX={index}u"] for index in range(samples)],
                 function="angle", **more)


def use(name, bounds, *broken, **more):
    return Proof(name, ["proof_use.c"], USE, 5, bounds, broken, **more)


def driver(name, *broken, **more):
    return Proof("driver_" + name, DRIVER_FILES, DRIVER, 22, ANY_LIDAR, broken, loops="fill_memory.0:65", **more)


PROOFS = [
    ring("init", "tmini_ring.c", " || (size & (size - 1)) != 0", ""),
    ring("put", "tmini_ring.c", "(room < to_end ? room : to_end)", "room"),
    ring("write", "tmini_ring.c", "memcpy(ring->memory, &bytes[first],", "memcpy(ring->memory, bytes,"),
    ring("publish", "tmini_ring.c", "((position - head) & (ring->size - 1))", "(position - head)"),
    ring("gap", "tmini_ring.c", "ring->head) <= ring->size) {", "ring->head) < ring->size) {"),
    ring("discard", "tmini_ring.h", "ring->tail + count);", "ring->tail + count + 1);"),
    ring("open", "tmini_ring.h", "tmini_ring_discard(ring, TMINI_RING_CLOSED);",
         "tmini_ring_discard(ring, TMINI_RING_CLOSED / 2);"),
    ring("read", "tmini_ring.c", "memory[index++ & mask]", "memory[index++]"),
    Proof("frame_samples", ["proof_frame.c"], FRAME, 4, ANY_RING,
          ("tmini_frame.c", "if (bytes < TMINI_SAMPLE_SIZE)", "if (bytes < 2)"), loops="fill_memory.0:33"),
    Proof("frame_content", ["proof_frame.c"], FRAME, 65, "ring of 64 bytes, all indices",
          ("tmini_frame.h", "TMINI_REPLY_HEADER_SIZE, content, count", "0, content, count")),
    parser("init", "tmini_parser.c", "ring->window >= TMINI_REPLY_SIZE_MAX;", "true;",
           bounds="ring of 32 bytes, DMA 16"),
    parser("await", "tmini_parser.c", "header->length > parser->frame.ring->window",
           "header->length > parser->frame.ring->size"),
    parser("judge", "tmini_parser.c", "header[LSN] >= 1 && ", "", stubs=["checksum_matches"]),
    parser("xor_piece", "tmini_parser.c", "third ^= tmini_word(sample + 8)", "third ^= tmini_word(sample + 4)",
           unwind=5, bounds="up to 9 samples in one piece", loops="prove_parser_xor_piece.0:28,contribution.0:28"),
    parser("checksum", "tmini_parser.c", "left -= count;", "left = 0;", unwind=5,
           bounds=EARLY + ", up to 3 samples", loops="fill_memory.0:33,prove_parser_checksum.0:10,"
           "prove_parser_checksum.1:10,contribution.0:10", slow=True),
    parser("skip", "tmini_parser.c", "skipped < count && begins_no_frame(parser, bytes[skipped])",
           "skipped < count", slow=True),
    parser("drop_overwritten", "tmini_parser.c", "parser->counters.bytes_overrun += (uint32_t)lost;", ""),
    parser("pass_lost_bytes", "tmini_parser.c", "if (unread == 0) {", "if (unread < 2) {", slow=True),
    parser("release", "tmini_parser.c", "        frame->gap = 0;", ""),
    parser("deliver", "tmini_parser.c", "parser->counters.bytes_in_packets += frame->size;", ""),
    parser("skip_all", "tmini_parser.c", "skip_bytes(parser, count);", "skip_bytes(parser, 1);"),
    parser("abandon", "tmini_parser.c", "if (unread == 0 || unread >= parser->need)",
           "if (unread >= parser->need)", slow=True),
    parser("next", "tmini_parser.c",
           "        if (!judge(parser, unread)) {\n            skip(parser, unread);\n        } else if", "        if",
           slow=True, cases=[["FED_BY_DMA=true"], ["FED_BY_DMA=false"]], replaced=["judge:any_judge", "skip:any_skip"],
           loops="tmini_parser_next_after.0:3",
           inserted=("tmini_parser.c", "    do {\n        const", "    do {\n        at_loop_head();\n        const")),
    scan("packet_open", "tmini_packet.c", "angle < TMINI_FULL_CIRCLE_Q6 ?", "angle <= TMINI_FULL_CIRCLE_Q6 ?"),
    scan("packet_points", "tmini_packet.c", "packet->count < max_points ? packet->count : max_points", "packet->count"),
    angle(2, "tmini_packet.c", "    wrap(packet->first_angle_q6, point, 1);", ""),
    angle(3, "tmini_packet.c", "(STEP_BITS - 1))", "(STEP_BITS - 2))"),
    angle(7, "tmini_packet.c", "+ intervals - 1) / intervals", ") / intervals", slow=True),
    angle(40, "tmini_packet.c", "(STEP_BITS - 1))", "(STEP_BITS - 2))", slow=True),
    scan("scan_init", "tmini_builder.c", "capacity == 0 || ", ""),
    scan("scan_step", "tmini_builder.c", "(size_t)builder->capacity - scan->count)", "(size_t)builder->capacity)"),
    scan("scan_refute", "tmini_builder.c", "count_one(&builder->scan.gaps);\n}\n\nbool tmini_builder_add",
         "}\n\nbool tmini_builder_add"),
    scan("ct_crc", "tmini_ct.c", "sum << 6", "sum << 5"),
    scan("ct_add", "tmini_ct.c", " || start->gap != 1", ""),
    scan("ct_read", "tmini_ct.c", "trusted[DAY] >> 3", "trusted[DAY] >> 2"),
    use("bins", "all angles, 1 to 65535 bins or sectors", "tmini_bins.h", "(bin < count ? bin : 0)", "(bin)"),
    use("ranges_of_scan", "up to 3 points, 4 bins", "tmini_ranges.c", "count == 0 || ", ""),
    use("sectors", "up to 3 points, 4 sectors", "tmini_bins.h", "(bin < count ? bin : 0)", "(bin)"),
    use("mount_angle", "all directions, all angles", "tmini_mount.c", "while (within_q6 >= CIRCLE_Q6)",
        "while (within_q6 >= 2 * CIRCLE_Q6)", loops="tmini_mount_angle.0:4,tmini_mount_angle.1:4"),
    use("mount", "up to 3 points, 1 arc, two turns each way", "tmini_mount.c", "i < scan->count; i++",
        "i <= scan->count; i++"),
    use("time", "up to 3 points", "tmini_units.c", "(turned < JITTER_Q6 ? TURN_Q6 : 0)", "TURN_Q6"),
    driver("init", "tmini.c", " || config->max_points != 0", ""),
    driver("look", "tmini_driver.h", "if (lidar->command.phase == TMINI_PHASE_IDLE) {", "if (true) {"),
    driver("take_event", "tmini_recovery.c", "unsigned event = TMINI_EVENT_NONE;",
           "unsigned event = TMINI_EVENT_STARTED;"),
    driver("next", "tmini_decoder.h", "if (builder->ended) {", "if (false) {"),
    driver("poll", "tmini.c", "if (lidar->pending != 0) {\n        return take_event",
           "if (is_done) {\n        return take_event", stubs=["look", "receive", "keep_time"]),
    driver("packet", "tmini.c", "tmini_command_end(lidar, TMINI_ERROR_ABORTED);\n    if", "if"),
    driver("reply", "tmini_command.c", "|| frequency_chz > PLAUSIBLE_CHZ_MAX", "|| frequency_chz > 65535", slow=True),
    driver("nothing", "tmini.c", "tmini_parser_abandon(&lidar->decoder.parser);",
           "(tmini_command_end(lidar, TMINI_ERROR_ABORTED), true);"),
    driver("advance", "tmini_command.c", "command->steps >= STEPS_MAX) {", "command->steps > STEPS_MAX) {", slow=True),
    driver("start", "tmini.c", "        if (is_to_scan(lidar)) {", "        if (false) {"),
    driver("request_info", "tmini.c",
           "(tmini_recovery_wishes(lidar, TMINI_EVENT_STARTED)) {\n        return TMINI_ERROR_STATE;",
           "(false) {\n        return TMINI_ERROR_STATE;"),
    driver("request_health", "tmini.c", "    tmini_recovery_wish(lidar, event);\n    act", "    act"),
    driver("request_frequency", "tmini_command.c", "command->unsent |= ", "command->unsent = "),
    driver("set_frequency", "tmini.c", " || frequency_chz > TMINI_FREQUENCY_MAX_CHZ", ""),
    driver("stop", "tmini_command.c", "sent >= sizeof bytes", "sent == sizeof bytes"),
    driver("reboot", "tmini.c", "take_wish(lidar, TMINI_EVENT_REBOOTED)", "take_wish(lidar, TMINI_EVENT_INFO)"),
    driver("withdraw", "tmini.c", "    tmini_recovery_forget_wish(lidar, query);\n    if", "    if"),
    driver("time", "tmini.c", "return age_ms < AGE_MAX_MS ? age_ms : AGE_MAX_MS;", "return age_ms;"),
]


def run(*command, must=False):
    done = subprocess.run(["nice", "-n", "19", *command], capture_output=True, text=True, check=False)
    if must and done.returncode != 0:
        sys.exit(f"{command[0]} ended with {done.returncode}\n{done.stdout}{done.stderr}")
    return done


class Checker:
    """Runs CBMC on a copy of the sources."""

    def __init__(self, work):
        self.folder = Path(work)

    def copy_sources(self):
        for folder in FOLDERS:
            shutil.rmtree(self.folder / folder, ignore_errors=True)
            shutil.copytree(ROOT / folder, self.folder / folder)

    def replace(self, name, old, new, only_look=False):
        (path,) = (self.folder / "lib").rglob(name)
        text = path.read_text(encoding="utf-8")
        if text.count(old) != 1:
            sys.exit(f"{name} has {text.count(old)} times {old!r}: bring the table in prove.py up to date")
        if not only_look:
            path.write_text(text.replace(old, new), encoding="utf-8")

    def check(self, proof, case):
        """The number of properties and the failed ones; `case` is a list of macros."""
        program, main_file = self.folder / "program", self.folder / "main.c"
        # Runs the proof, and then claims what must fail.
        main_file.write_text(f"void {proof.function}(void); int main(void) {{ {proof.function}(); "
                             f"__CPROVER_assert(0, \"{NOT_REACHED}\"); }}\n", encoding="utf-8")
        files = [main_file, self.folder / "test/support/invariants.c",
                 *(self.folder / "test/qa/proof" / name for name in ["any.c"] + proof.files),
                 *(self.folder / "lib/src" / name for name in proof.sources)]
        macros = ("TMINI_MEMCPY_ONLY", 'TMINI_ATOMIC_HEADER="proof_atomic.h"', *case)
        run("goto-cc", *(f"-D{macro}" for macro in macros), *(f"-I{self.folder / folder}" for folder in FOLDERS),
            "-o", program, *files, must=True)
        for stub in proof.stubs:
            run("goto-instrument", "--remove-function-body", stub, program, program, must=True)
            run("goto-instrument", "--generate-function-body", stub, "--generate-function-body-options",
                "nondet-return", program, program, must=True)
        for calls in proof.replaced:
            run("goto-instrument", "--replace-calls", calls, program, program, must=True)
        loops = ["--unwindset", proof.loops] if proof.loops else []
        # Each copy of two bytes creates objects: more than CBMC's default limit of 2^8.
        done = run("cbmc", "--drop-unused-functions", "--object-bits", "12", "--unwind", str(proof.unwind), *loops,
                   program)
        count = re.search(r"^\*\* \d+ of (\d+) failed", done.stdout, re.MULTILINE)
        if not count:
            sys.exit(f"{proof.name}: CBMC has not finished\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
        return int(count.group(1)), re.findall(r"^\[.*: FAILURE$", done.stdout, re.MULTILINE)


def seconds():
    """The processor time of all child processes: other programs may be running, too."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def is_end(failure):
    return NOT_REACHED in failure


def prove(checker, proof, broken):
    """Returns the number of properties, whether the result is as expected, and complaints."""
    checker.copy_sources()
    checker.replace(*proof.broken, only_look=not broken)  # Also checks that the table is up to date.
    if proof.inserted:
        checker.replace(*proof.inserted)
    total, complaints = 0, []
    for case in proof.cases:
        count, failures = checker.check(proof, case)
        total += count
        complaints += [failure for failure in failures if not is_end(failure)]
        if broken and complaints:
            return total, True, []
        if not broken and not any(is_end(failure) for failure in failures):
            complaints.append(f"{NOT_REACHED}: nothing was proved")
    if broken:
        return total, False, ["nothing failed although the library is broken"]
    return total, not complaints, complaints


def main():
    parser_ = argparse.ArgumentParser(description="Proves what proof_….c claim.")
    parser_.add_argument("--work", required=True, help="a folder to work in")
    parser_.add_argument("--quick", action="store_true", help="only what takes at most ten seconds")
    parser_.add_argument("--broken", action="store_true", help="break the library: each proof must fail")
    parser_.add_argument("names", nargs="*", metavar="NAME", help="proofs, or the beginnings of their names")
    arguments = parser_.parse_args()
    chosen = [proof for proof in PROOFS
              if (not arguments.names or any(proof.name.startswith(name) for name in arguments.names)) and
              not (arguments.quick and proof.slow)]
    if not chosen:
        sys.exit("no such proof; there are: " + " ".join(proof.name for proof in PROOFS))
    checker = Checker(arguments.work)
    total = failed = 0
    print(f"{'proof':26} {'result':8} {'properties':>10} {'CPU s':>5}  bounds")
    for proof in chosen:
        begin = seconds()
        count, is_right, complaints = prove(checker, proof, arguments.broken)
        result = ("fails" if arguments.broken else "proved") if is_right else "WRONG"
        print(f"{proof.name:26} {result:8} {count:10} {seconds() - begin:5.0f}  {proof.bounds}", flush=True)
        for complaint in complaints:
            print(f"    {complaint}")
        total += count
        failed += not is_right
    print(f"{len(chosen)} proofs, {total} properties, {failed} wrong")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
