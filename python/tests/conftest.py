"""What tests share."""

import csv
import io
import os
import pathlib
import signal
import subprocess
import threading
import time

import pytest

# A job in the background inherits that Ctrl-C is ignored, and hands it on to the programs that tests start
signal.signal(signal.SIGINT, signal.default_int_handler)

ROOT = pathlib.Path(__file__).resolve().parents[2]


def time_to_interrupt(work, delay=0.5):
    """Seconds from Ctrl-C to its exception, or those that all threads work until then if they are fewer, as tests share their
    machine: the best of three attempts.
    """

    def attempt():
        begun, clock = [], []

        def interrupt():
            time.sleep(delay)
            begun.append(time.process_time())
            clock.append(time.perf_counter())
            os.kill(os.getpid(), signal.SIGINT)

        thread = threading.Thread(target=interrupt)
        thread.start()
        with pytest.raises(KeyboardInterrupt):
            work()
            thread.join()  # Ctrl-C comes here at the latest, and fails the test, not the run of all tests
        seconds = time.perf_counter() - clock[0]
        assert seconds < 30  # It does not wait, either
        seconds = min(seconds, time.process_time() - begun[0])
        thread.join()
        return seconds

    return min(attempt() for _ in range(3))


@pytest.fixture(scope="session")
def command():
    """The `translucid` command: a function from its words to the rows that it prints, as dicts of numbers."""
    places = [os.environ.get("TRANSLUCID_COMMAND"), ROOT / "target/release/translucid", ROOT / "target/debug/translucid"]
    found = [str(place) for place in places if place and pathlib.Path(place).is_file()]
    if not found:
        pytest.skip("no translucid command: build it, or name it in TRANSLUCID_COMMAND")

    def number(text):
        try:
            return float(text)
        except ValueError:
            return text

    def run(*words):
        done = subprocess.run([found[0], *map(str, words)], capture_output=True, text=True, check=True)
        return [{name: number(text) for name, text in row.items()} for row in csv.DictReader(io.StringIO(done.stdout))]

    return run
