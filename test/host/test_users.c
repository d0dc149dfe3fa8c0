/* SPDX-License-Identifier: MIT */
/* Copyright (c) 2026 The tmini authors */

/* A program that holds a port open is found, though its command line does not name the port. (The
 * ports of other tests are pseudo-terminals, whose numbers come again.) */

#define _XOPEN_SOURCE 700

#include "users.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "unity.h"

#define FOLDER "users_root/proc/800"

static void write_file(const char *path, const char *content)
{
    FILE *const file = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(file);
    (void)fputs(content, file);
    (void)fclose(file);
}

static void link_to(const char *target, const char *path)
{
    (void)unlink(path);
    TEST_ASSERT_EQUAL_INT(0, symlink(target, path));
}

/* Its descriptor 3 is "port_it_holds". */
void setUp(void)
{
    (void)mkdir("users_root", 0777);
    (void)mkdir("users_root/proc", 0777);
    (void)mkdir(FOLDER, 0777);
    (void)mkdir(FOLDER "/fd", 0777);
    write_file("port_it_holds", "");
    write_file("another_port", "");
    write_file(FOLDER "/stat", "800 (reader) S 1 800");
    write_file(FOLDER "/cmdline", "reader");
    link_to("/dev/null", FOLDER "/fd/0");
    link_to("../../../../port_it_holds", FOLDER "/fd/3");
    TEST_ASSERT_EQUAL_INT(0, setenv("TMINI_ROOT", "users_root", 1));
}

void test_who_holds_the_port_is_named(void)
{
    char text[USERS_TEXT_SIZE];
    TEST_ASSERT_EQUAL_STRING("reader (process 800) uses port_it_holds",
                             users_find("port_it_holds", text));
    TEST_ASSERT_EQUAL_STRING("", users_find("another_port", text));
    TEST_ASSERT_EQUAL_STRING("", users_find("no_port", text));
}
