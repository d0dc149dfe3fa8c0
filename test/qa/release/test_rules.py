# SPDX-License-Identifier: MIT
# Copyright (c) 2026 The tmini authors

"""Tests the rules of .ci/version.py and .ci/pack.py on a copy of the project.

    test_rules.py
"""

import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
LEFT_OUT = shutil.ignore_patterns("build*", ".git", "test", "__pycache__")


class Rules(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name, "tmini")
        shutil.copytree(ROOT, self.root, ignore=LEFT_OUT)

    def run_script(self, name, *arguments):
        return subprocess.run([sys.executable, "-B", self.root / ".ci" / name, *arguments],
                              capture_output=True, text=True, check=False)

    def write(self, name, pattern, text):
        path = self.root / name
        content, count = re.subn(pattern, text, path.read_text(encoding="utf-8"), count=1)
        self.assertEqual(count, 1)
        path.write_text(content, encoding="utf-8")

    def read(self, name):
        return (self.root / name).read_text(encoding="utf-8")

    def release(self, *arguments):
        return self.run_script("pack.py", *arguments, self.root.parent / "out")

    def test_no_job_that_runs_the_projects_scripts_may_write_to_the_repository(self):
        jobs = [job for path in (ROOT / ".github/workflows").iterdir() for job in
                re.split(r"^  (?=\w+:$)", path.read_text(encoding="utf-8").partition("\njobs:\n")[2],
                         flags=re.MULTILINE)[1:]]
        self.assertGreaterEqual(len(jobs), 3)
        for job in jobs:
            self.assertFalse("contents: write" in job and ("checkout" in job or ".ci/" in job), job)
            self.assertEqual(job.count("actions/checkout@"), job.count("persist-credentials: false"), job)

    def test_a_place_with_another_version_is_named(self):
        self.write("library.json", '"version": "[^"]*"', '"version": "0.9.0"')
        checked = self.run_script("version.py")
        self.assertEqual(checked.returncode, 1)
        self.assertRegex(checked.stdout, "^library.json: 0.9.0 should be ")

    def test_one_command_gives_each_manifest_the_version_in_its_own_spelling(self):
        self.run_script("version.py", "--write", "2.3.4-rc.5")
        self.assertEqual(self.run_script("version.py").returncode, 0)
        self.assertIn("project(tmini VERSION 2.3.4\n", self.read("CMakeLists.txt"))
        self.assertIn('version = "2.3.4rc5"', self.read("port/python/pyproject.toml"))
        self.assertIn('version: "2.3.4-rc.5"', self.read("idf_component.yml"))

    def test_work_after_a_release_has_a_section_of_its_own_which_the_release_dates(self):
        self.run_script("version.py", "--write", "2.3.4")
        released = self.read("CHANGELOG.md")
        self.run_script("version.py", "--write", "2.4.0-dev")
        self.assertEqual(self.read("CHANGELOG.md"),
                         re.sub("^## ", "## 2.4.0-dev\n\n## ", released, count=1, flags=re.MULTILINE))
        self.run_script("version.py", "--write", "2.4.0")
        self.assertRegex(self.read("CHANGELOG.md"), r"\n## 2\.4\.0 \(\d{4}-\d\d-\d\d\)\n\n## 2\.3\.4 \(")
        self.assertNotIn("-dev", self.read("CHANGELOG.md"))

    def test_a_placeholder_is_not_released_and_one_edit_makes_it_an_address(self):
        self.write("CMakeLists.txt", 'HOMEPAGE_URL "[^"]*"', 'HOMEPAGE_URL "https://lidar.example/x"')
        self.run_script("version.py", "--write", "2.3.4")
        self.assertRegex(self.release().stderr, "lidar.example/x is a placeholder")
        self.assertEqual(self.release("--allow-placeholder").returncode, 0)
        self.write("CMakeLists.txt", 'HOMEPAGE_URL "[^"]*"', 'HOMEPAGE_URL "https://lidar.test/y"')
        self.run_script("version.py", "--write")
        self.assertEqual(self.release().stderr, "")
        for archive in self.root.parent.glob("out/*.zip"):
            with zipfile.ZipFile(archive) as files:
                for name in files.namelist():
                    self.assertNotIn(b"lidar.example", files.read(name), name)

    def test_in_an_unpacked_archive_what_builds_leave_is_not_packed(self):
        self.release("--allow-placeholder")
        before = (self.root.parent / "out/SHA256SUMS").read_text(encoding="utf-8")
        for left in ("build/bin/tmini", "build-clang/x.o", "port/python/tmini.egg-info/PKG-INFO", ".pio/x.o",
                     "examples/esp32_idf/sdkconfig.old", "test/host/__pycache__/x.pyc"):
            path = self.root / left
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        self.release("--allow-placeholder")
        self.assertEqual((self.root.parent / "out/SHA256SUMS").read_text(encoding="utf-8"), before)

    def test_a_version_in_development_or_with_a_wrong_tag_is_not_released(self):
        self.run_script("version.py", "--write", "2.4.0-dev")
        self.assertRegex(self.release().stderr, "2.4.0-dev is a version in development")
        self.assertRegex(self.release("--tag", "v2.3.4").stderr, "v2.3.4 is not v2.4.0-dev")

    def test_notes_and_tag_message_are_the_topmost_section_of_the_changes(self):
        section = "- One, see [two](docs/design.md).\n\n### Three\n\n- Four.\n"
        self.write("CHANGELOG.md", r"(?s)\n## .*",
                   f"\n## 2.3.4 (2026-01-02)\n\n{section}\n## 2.3.3 (2026-01-01)\n\nOld.\n")
        self.run_script("version.py", "--write", "2.3.4")
        home = re.search('HOMEPAGE_URL "(.*)"', self.read("CMakeLists.txt"))[1]
        self.assertEqual(self.run_script("notes.py").stdout, section.replace("docs/", f"{home}/blob/v2.3.4/docs/"))
        self.assertEqual(self.run_script("notes.py", "--tag").stdout,
                         "tmini 2.3.4\n\n" + section.replace("### Three", "Three:"))


if __name__ == "__main__":
    unittest.main()
