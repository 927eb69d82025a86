# SPDX-License-Identifier: Apache-2.0
"""A scheduler and workers of Dask as processes of their own, which tests may kill."""

import os
import signal
import socket
import subprocess
import sys


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Cluster:
    """Starts at once; workers come when they can. Ends what it started."""

    def __init__(self, folder, workers=3):
        self._folder, self._port = folder, free_port()
        self._workers, self._processes = workers, []
        self.start()

    @property
    def address(self):
        return f"tcp://127.0.0.1:{self._port}"

    def start(self):
        self.scheduler = self._run("scheduler", "--host", "127.0.0.1", "--port", self._port, "--no-dashboard")
        self._processes = [self.scheduler] + [
            self._run("worker", self.address, "--nthreads", 1, "--no-nanny", "--no-dashboard",
                      "--local-directory", self._folder / str(i)) for i in range(self._workers)]

    def _run(self, role, *arguments):
        command = [sys.executable, "-m", f"distributed.cli.dask_{role}", *map(str, arguments)]
        log = open(self._folder / "log.txt", "ab")
        return subprocess.Popen(command, stdout=log, stderr=log, cwd=self._folder,
                                env={**os.environ, "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "120s"})

    def stop(self):
        for process in self._processes:
            process.send_signal(signal.SIGKILL)
            process.wait()

    def restart(self):
        """As a batch system does after the scheduler's machine has failed: same address, new processes."""
        self.stop()
        self.start()
