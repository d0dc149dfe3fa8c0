/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/** @file
 * What a call came to: 0 is success, negative values are errors. */

#ifndef TMINI_STATUS_H
#define TMINI_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

/** The result of a call. tmini_names.h has each as text. */
typedef enum {
    TMINI_OK = 0,              /**< Success: done, or begun. */
    TMINI_ERROR_ARGUMENT = -1, /**< A null pointer, or a value outside its documented range. */
    TMINI_ERROR_STATE = -2,    /**< Not now: while scanning, only stop may be sent (section 2). */
    TMINI_ERROR_BUSY = -3,     /**< Not yet: an earlier command has not finished. */
    TMINI_ERROR_TIMEOUT = -4,  /**< The lidar did not answer, or would not fall quiet, in time. */
    TMINI_ERROR_WRITE = -5,    /**< The port's write function failed, or took nothing too long. */
    TMINI_ERROR_REPLY = -6,    /**< The lidar answered, but not what the command asked of it. */
    TMINI_ERROR_ABORTED = -7,  /**< A stop ended the command before it had finished. */
} tmini_status_t;

#ifdef __cplusplus
}
#endif

#endif
