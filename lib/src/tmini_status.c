/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "tmini/tmini_status.h"

const char *tmini_status_name(tmini_status_t status)
{
    switch (status) {
    case TMINI_OK:
        return "ok";
    case TMINI_ERROR_ARGUMENT:
        return "invalid argument";
    case TMINI_ERROR_STATE:
        return "not while scanning";
    case TMINI_ERROR_BUSY:
        return "busy with another command";
    case TMINI_ERROR_TIMEOUT:
        return "timeout";
    case TMINI_ERROR_WRITE:
        return "write failed";
    case TMINI_ERROR_REPLY:
        return "unexpected reply";
    case TMINI_ERROR_ABORTED:
        return "aborted";
    }
    return "unknown status";
}
