# SPDX-License-Identifier: Apache-2.0
"""A share that goes wrong: share.py FOLDER MOUNTPOINT shows FOLDER, read only. FOLDER.fault, while it is there, says "CALL PATH HOW":
getattr, readdir, open or read of that path fails with the error number HOW, or with "hang" has no answer."""
import errno
import os
import pathlib
import sys
import time

import fuse

fuse.fuse_python_api = (0, 2)
FOLDER = pathlib.Path(sys.argv[1])
FAULT = FOLDER.with_suffix(".fault")


def fault(call, path):
    """0: none."""
    while True:
        try:
            wrong, where, how = FAULT.read_text().split()
        except FileNotFoundError:
            return 0
        if (wrong, where) != (call, path):
            return 0
        if how != "hang":
            return -int(how)
        time.sleep(0.1)


class Share(fuse.Fuse):
    def getattr(self, path):
        try:
            return fault("getattr", path) or os.lstat(str(FOLDER) + path)
        except OSError as e:
            return -e.errno

    def readdir(self, path, offset):
        wrong = fault("readdir", path)
        if wrong:
            raise OSError(-wrong, "on purpose")
        return [fuse.Direntry(name) for name in [".", "..", *os.listdir(str(FOLDER) + path)]]

    def open(self, path, flags):
        return fault("open", path) or (-errno.EROFS if flags & (os.O_WRONLY | os.O_RDWR) else 0)

    def read(self, path, size, offset):
        wrong = fault("read", path)
        if wrong:
            return wrong
        with open(str(FOLDER) + path, "rb") as file:
            file.seek(offset)
            return file.read(size)


share = Share()
share.parse([sys.argv[2], "-f", "-o", "attr_timeout=0,entry_timeout=0,negative_timeout=0,direct_io"], errex=1)
share.main()
