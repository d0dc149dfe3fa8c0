/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* For tables that name members of a configuration: stores a number in a member of any size. */

#ifndef MEMBERS_H
#define MEMBERS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* For the columns "member" and "size". */
#define MEMBER(name) &name, sizeof name

static inline void member_store(void *member, size_t size, uint64_t number)
{
    const uint8_t one = (uint8_t)number;
    const uint16_t two = (uint16_t)number;
    const uint32_t four = (uint32_t)number;

    memcpy(member,
           size == 1   ? (const void *)&one
           : size == 2 ? (const void *)&two
           : size == 4 ? (const void *)&four
                       : (const void *)&number,
           size);
}

#endif
