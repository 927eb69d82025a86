# SPDX-License-Identifier: Apache-2.0
"""Slurm on one node, this machine, with folders and ports of its own: munged, slurmctld, slurmd."""

import os
import shutil
import socket
import subprocess
import time

from cluster import free_port

NEEDED = ("munged", "slurmctld", "slurmd", "sbatch", "sinfo")

CONFIG = """
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CryptoType=crypto/munge
SlurmUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/controller.pid
SlurmdPidFile={folder}/node.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
NodeName={host} NodeAddr=127.0.0.1 CPUs={processors} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def why_not():
    """Why there can be no Slurm here; None where there can."""
    path = os.environ["PATH"] + ":/usr/sbin:/sbin"
    missing = [name for name in NEEDED if shutil.which(name, path=path) is None]
    if missing:
        return f"not installed: {', '.join(missing)}"
    return None if os.geteuid() == 0 else "Slurm's daemons are started as root"


class Slurm:
    """Its daemons. `environment` leads its commands to them."""

    def __init__(self, folder):
        self._folder, self._daemons = folder, []
        for name in ("state", "spool"):
            (folder / name).mkdir()
        key = folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        config = folder / "slurm.conf"
        config.write_text(CONFIG.format(host=socket.gethostname().split(".")[0], folder=folder,
                                        controller_port=free_port(), node_port=free_port(), processors=os.cpu_count()))
        self.environment = {**os.environ, "SLURM_CONF": str(config), "PATH": os.environ["PATH"] + ":/usr/sbin:/sbin"}
        self._start("munged", "--foreground", "--force", f"--key-file={key}", f"--socket={folder}/munge.socket",
                    f"--pid-file={folder}/munge.pid", f"--seed-file={folder}/munge.seed",
                    f"--log-file={folder}/munge.log")
        self._start("slurmctld", "-D")
        self._start("slurmd", "-D")

    def _start(self, *command):
        with open(self._folder / f"{command[0]}.log", "wb") as log:
            self._daemons.append(subprocess.Popen(command, stdout=log, stderr=log, env=self.environment))

    def comes_up(self, seconds=60):
        """Whether its node is ready, after this time at most."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self._run("sinfo", "--noheader", "--format=%T").strip() == "idle":
                return True
            if any(daemon.poll() is not None for daemon in self._daemons):
                return False
            time.sleep(0.2)
        return False

    def _run(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False).stdout

    def _cancel_jobs(self, seconds=20):
        self._run("scancel", "--partition=all")
        end = time.monotonic() + seconds
        while self._run("squeue", "--noheader") and time.monotonic() < end:
            time.sleep(0.2)

    def stop(self):
        self._cancel_jobs()
        for daemon in reversed(self._daemons):
            daemon.terminate()
            try:
                daemon.wait(timeout=20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()
