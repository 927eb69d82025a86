# SPDX-License-Identifier: Apache-2.0
"""examples/cluster as their comments say: Snakemake, Slurm on this machine, and GNU parallel."""

import os
import pathlib
import shutil
import subprocess
import sys

import fathom
import pytest
import slurm
from pictures import noise, stack, write_pgm

PROGRAM = pathlib.Path(os.environ["FATHOM_PROGRAM"])
EXAMPLES = pathlib.Path(os.environ["FATHOM_SOURCE"]) / "examples" / "cluster"


def shell(command, folder, environment=os.environ):
    path = f"{PROGRAM.parent}:{environment['PATH']}"
    done = subprocess.run(["bash", "-c", command], cwd=folder, env={**environment, "PATH": path}, capture_output=True,
                          text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "plate").mkdir()
    for i in range(7):
        write_pgm(tmp_path / "plate" / f"{i}.pgm", noise((80, 90), seed=i))
    shell("fathom score plate/*.pgm --metric fft:64:hann --json > alone.json && fathom merge alone.csv alone.json", tmp_path)
    return tmp_path


def assert_whole(folder):
    table = (folder / "scores.csv").read_text()
    assert table == (folder / "alone.csv").read_text() and table.count("\n") == 8


@pytest.mark.skipif(shutil.which("snakemake") is None, reason="snakemake is not installed")
def test_snakemake_makes_the_table_and_does_nothing_again(folder):
    command = (f"HOME={folder} snakemake --snakefile {EXAMPLES}/Snakefile --cores 2 "
               "--config pictures='plate/*.pgm' shards=3 2>&1")
    shell(command, folder)
    assert_whole(folder)
    (folder / "parts" / "2.json").unlink()  # of a job that was killed
    (folder / "scores.csv").unlink()
    said = shell(command, folder)
    assert said.count("rule shard:") == 1
    assert_whole(folder)


@pytest.mark.skipif(shutil.which("parallel") is None, reason="GNU parallel is not installed")
def test_gnu_parallel(folder):
    shell("mkdir parts && parallel fathom score plate/*.pgm --metric fft:64:hann --json --shard {}/3 '>' parts/{}.json ::: 1 2 3"
          " && fathom merge scores.csv parts/*.json", folder)
    assert_whole(folder)


@pytest.fixture(scope="module")
def batch(tmp_path_factory):
    if slurm.why_not():
        pytest.skip(slurm.why_not())
    one = slurm.Slurm(tmp_path_factory.mktemp("slurm"))
    if not one.comes_up():
        one.stop()
        pytest.skip("Slurm does not start on this machine")
    yield one
    one.stop()


def test_slurm_scores_by_an_array_of_jobs(batch, folder):
    shell("mkdir parts", folder)
    submit = f"sbatch --wait --array=%s {EXAMPLES}/score.sbatch plate/*.pgm"
    shell(submit % "1-3", folder, batch.environment)
    (folder / "parts" / "2.json").unlink()
    shell(submit % "2", folder, {**batch.environment, "SHARDS": "3"})
    shell("fathom merge scores.csv parts/*.json", folder)
    assert_whole(folder)


def test_slurm_runs_the_workers_of_a_screening(batch, tmp_path):
    distributed = pytest.importorskip("distributed")
    tifffile = pytest.importorskip("tifffile")
    for i in range(4):
        tifffile.imwrite(tmp_path / f"{i}.tif", stack(planes=9, focus=2 + i, side=64, seed=i))
    with distributed.LocalCluster(n_workers=0, dashboard_address=None) as cluster, distributed.Client(
            cluster, timeout="120s", set_as_default=False) as client:
        client.write_scheduler_file(str(tmp_path / "scheduler.json"))
        shell(f"sbatch --array=1-2 {EXAMPLES}/workers.sbatch scheduler.json", tmp_path,
              {**batch.environment, "PYTHON": sys.executable})
        client.wait_for_workers(1, timeout=120)  # the other may have to wait for a processor
        rows = fathom.screen(tmp_path / "*.tif", "walsh-sequency:32", out=tmp_path / "table.csv", client=client)
    assert rows == fathom.screen(tmp_path / "*.tif", "walsh-sequency:32", out=tmp_path / "alone.csv")
    assert [round(row.position) for row in rows] == [2, 3, 4, 5]
