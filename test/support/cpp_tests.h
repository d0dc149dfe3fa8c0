/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* Tests in C++: TEST(name) { … } defines a test and adds it to those that cpp_tests.cpp runs, in
 * the order of the file. */

#ifndef CPP_TESTS_H
#define CPP_TESTS_H

#include "unity.h"

struct CppTest {
    CppTest(void (*run)(), const char *name, const char *file, int line);
};

#define TEST(name)                                                      \
    static void name();                                                 \
    static const CppTest added_##name(name, #name, __FILE__, __LINE__); \
    static void name()

#endif
