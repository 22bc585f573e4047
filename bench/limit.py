# SPDX-License-Identifier: Apache-2.0
"""limit.py OUT: the least cost of a run that wrote OUT, as CPU time per campaign: the kernel's part of writing the same
files as durably, their SHA-256, and the deflate of the reports' pages. Nothing else is done."""
import ctypes
import ctypes.util
import hashlib
import os
import pathlib
import re
import resource
import sys
import tempfile
import time
import zlib

BATCH = 64  # campaigns that share their flushes, as in a run
TEMPORARY = ".nonio-tmp"


def results_in(out):
    """The files of each campaign, the record last."""
    folders = sorted(record.parent for record in pathlib.Path(out).rglob("run.json"))
    every = [{p.name: p.read_bytes() for p in sorted(f.iterdir()) if p.is_file()} for f in folders]
    return [dict(sorted(files.items(), key=lambda item: item[0] == "run.json")) for files in every]


def stage(folder, files):
    os.mkdir(folder)
    for name, data in files.items():
        fd = os.open(f"{folder}/.{name}{TEMPORARY}", os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o644)
        os.write(fd, data)
        os.close(fd)


def read_back(folder, files):
    for name in files:
        fd = os.open(f"{folder}/.{name}{TEMPORARY}", os.O_RDONLY | os.O_CLOEXEC)
        os.posix_fadvise(fd, 0, 0, os.POSIX_FADV_DONTNEED)
        os.read(fd, 1 << 20)
        os.close(fd)


def rename(folder, names):
    for name in names:
        os.rename(f"{folder}/.{name}{TEMPORARY}", f"{folder}/{name}")


def write_as_durably(root, campaigns):
    """Flush, read back, all names but the record's, flush, the record's, flush: whoever sees a record may rely on the
    files it lists."""
    flush = ctypes.CDLL(None, use_errno=True).syncfs
    disk = os.open(root, os.O_RDONLY | os.O_DIRECTORY)
    for first in range(0, len(campaigns), BATCH):
        some = [(f"{root}/{first + i}", files) for i, files in enumerate(campaigns[first:first + BATCH])]
        for folder, files in some:
            stage(folder, files)
        flush(disk)
        for folder, files in some:
            read_back(folder, files)
        for folder, files in some:
            rename(folder, list(files)[:-1])
        flush(disk)
        for folder, files in some:
            rename(folder, list(files)[-1:])
        flush(disk)
    os.close(disk)


def kernel_part(campaigns):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_stime
    with tempfile.TemporaryDirectory(prefix="nonio-limit-") as root:
        write_as_durably(root, campaigns)
        return resource.getrusage(resource.RUSAGE_SELF).ru_stime - before


def processor(work, items):
    began = time.process_time()
    for item in items:
        work(item)
    return time.process_time() - began


def pages_of(pdf):
    """The uncompressed contents of its pages: the streams without a type or a length of their own."""
    pages = []
    for found in re.finditer(rb"<<((?:[^<>]|<<|>>)*?)>>\s*stream\r?\n(.*?)endstream", pdf, re.S):
        if b"/Length1" in found[1]:
            continue
        try:
            text = zlib.decompress(found[2])
        except zlib.error:
            continue
        if b" re\n" in text or b"BT " in text:
            pages.append(text)
    return pages


def deflate_at(level):
    """As Nonio compresses pages; zlib where there is no libdeflate."""
    name = ctypes.util.find_library("deflate")
    if name is None:
        return lambda text: zlib.compress(text, level)
    library = ctypes.CDLL(name)
    library.libdeflate_alloc_compressor.restype = ctypes.c_void_p
    library.libdeflate_zlib_compress.restype = ctypes.c_size_t
    library.libdeflate_zlib_compress.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t, ctypes.c_char_p,
                                                 ctypes.c_size_t]
    compressor = library.libdeflate_alloc_compressor(level)
    room = ctypes.create_string_buffer(1 << 22)
    return lambda text: library.libdeflate_zlib_compress(compressor, text, len(text), room, len(room))


def limits(out):
    """Seconds a campaign, by what they are for."""
    campaigns = results_in(out)
    every = [data for files in campaigns for data in files.values()]
    pages = [page for files in campaigns for name, data in files.items() if name.endswith(".pdf")
             for page in pages_of(data)]
    n = len(campaigns)
    return {"kernel: writing the same files as durably": kernel_part(campaigns) / n,
            "SHA-256 of the files, when written and when read back": 2 * processor(hashlib.sha256, every) / n,
            f"deflate of the pages ({sum(map(len, pages)) / n / 1000:.0f} kB a campaign, libdeflate level 1)":
                processor(deflate_at(1), pages) / n}


def print_limits(out):
    found = limits(out)
    for what, seconds in found.items():
        print(f"{1e3 * seconds:8.3f} ms  {what}")
    print(f"{1e3 * sum(found.values()):8.3f} ms  the limit: all three together")
    return sum(found.values())


if __name__ == "__main__":
    print_limits(sys.argv[1])
