/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* What the parser's functions promise to their callers. proof_parser.c proves it for the parser;
 * parser_stub.c, which replaces the parser in the driver's proofs, assumes it and nothing else. */

#ifndef PARSER_CONTRACT_H
#define PARSER_CONTRACT_H

#include "proof.h"

/* What no function changes but init and await. */
bool same_expectations(const tmini_parser_t *before, const tmini_parser_t *after);

/* Of tmini_parser_next(), which has returned `type`. */
bool next_keeps_its_word(const tmini_parser_t *before, const tmini_parser_t *after,
                         tmini_frame_type_t type);

/* Of tmini_parser_skip_all() and tmini_parser_abandon(). */
bool skip_keeps_its_word(const tmini_parser_t *before, const tmini_parser_t *after);

#endif
