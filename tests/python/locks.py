# SPDX-License-Identifier: Apache-2.0
"""Whether others run while a call computes."""

import sys
import threading
import time


def looks_while(call):
    """How often this thread ran, of those looks that it took from when a thread was about to call."""
    begun, done, looks = threading.Event(), threading.Event(), []

    def work():
        begun.set()
        call()
        done.set()

    before = sys.getswitchinterval()
    sys.setswitchinterval(100)  # nobody gets the lock who is not given it
    try:
        thread = threading.Thread(target=work)
        thread.start()
        while not done.is_set():
            looks.append(begun.is_set())
            time.sleep(0)
        thread.join()
    finally:
        sys.setswitchinterval(before)
    return sum(looks)
