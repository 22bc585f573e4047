# SPDX-License-Identifier: Apache-2.0
"""Hook of mkdocs: the pages of docs/ link to files of plugins/ and samples/, so the site contains those files too."""
import os
import pathlib
import posixpath
import re

from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parents[1]
LINK = re.compile(r"(?<=\]\()(?![a-z]+:|/|#)([^)#\s]+)")


def in_tree(page):
    """The path of a page from the root of the tree."""
    return page if page.startswith(("plugins/", "samples/")) else f"docs/{page}"


def linked(page, target):
    return posixpath.normpath(posixpath.join(posixpath.dirname(in_tree(page)), target))


def on_files(files, config):
    known = {file.src_path for file in files}
    new = [file.src_path for file in files if file.src_path.endswith(".md")]
    while new:
        page = new.pop()
        for target in LINK.findall((ROOT / in_tree(page)).read_text("utf-8")):
            name = linked(page, target)
            if name.startswith(("plugins/", "samples/")) and (ROOT / name).is_file() and name not in known:
                known.add(name)
                files.append(File(name, str(ROOT), config["site_dir"], config["use_directory_urls"]))
                new += [name] if name.endswith(".md") else []
    if os.environ.get("NONIO_DEPFILE"):
        read = [ROOT / in_tree(file.src_path) for file in files if (ROOT / in_tree(file.src_path)).is_file()]
        read += [ROOT / hook for hook in config["hooks"]]
        site = pathlib.Path(config["site_dir"])
        pathlib.Path(os.environ["NONIO_DEPFILE"]).write_text(f"{site / 'index.html'}: {' '.join(map(str, read))}\n", "utf-8")
    return files


def on_page_markdown(markdown, page, **_):
    own = page.file.src_path

    def moved(found):
        name = linked(own, found[1]).removeprefix("docs/")
        return posixpath.relpath(name, posixpath.dirname(own) or ".")
    return LINK.sub(moved, markdown)
