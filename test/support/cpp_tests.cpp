/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

#include "cpp_tests.h"

#include <vector>

struct Known {
    void (*run)();
    const char *name;
    const char *file;
    int line;
};

static std::vector<Known> &known()
{
    static std::vector<Known> tests;
    return tests;
}

CppTest::CppTest(void (*run)(), const char *name, const char *file, int line)
{
    known().push_back({run, name, file, line});
}

int main()
{
    UnityBegin(known().front().file);
    for (const Known &test : known()) {
        UnityDefaultTestRun(test.run, test.name, test.line);
    }
    return UnityEnd();
}
