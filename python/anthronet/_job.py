"""Jobs: many bodies made beside the caller's thread."""

from __future__ import annotations

import ctypes
import time
from typing import Iterator, List, Literal, NamedTuple, Optional, Union, overload

from . import _arguments, _native
from ._body import Body
from ._errors import BusyError, CancelledError, Error, TakenError
from ._library import Handle, Owner, call, described, lib, new_handle
from ._request import Request

_STATES = {_native.JOB_RUNNING: "running", _native.JOB_DONE: "done", _native.JOB_CANCELLED: "cancelled"}

#: Seconds between two looks at a job: far below the time that a body takes.
_PAUSE = 0.001


class Progress(NamedTuple):
    """How far a job is."""

    #: `"running"`, `"done"` or `"cancelled"`.
    state: str
    #: Requests that have their body or error.
    done: int
    #: Requests altogether.
    total: int


class Job(Owner):
    """Requests that are being made into bodies by a thread of the library. May be used by many threads.

    Made by `Model.start`. Closing it, as the end of `with` does, cancels it.
    """

    _latent_size: int

    @classmethod
    def _new(cls, model: Handle, requests: List[Request], latent_size: int) -> Job:
        handles = [_arguments.instance(request, Request, "requests")._handle for request in requests]
        addresses = (ctypes.c_void_p * len(handles))(*[handle.value for handle in handles])
        self = cls.__new__(cls)
        made = Handle()
        call(lib.anthronet_job_start, model, addresses, len(handles), ctypes.byref(made))
        # Its thread has to end before the process does.
        self._handle, self._latent_size = made.kept(lib.anthronet_job_free, at_exit=True), latent_size
        return self

    @property
    def progress(self) -> Progress:
        """How far it is: state, done, total. Returns at once."""
        progress = described(_native.JobProgress)
        call(lib.anthronet_job_poll, self._open, ctypes.byref(progress))
        return Progress(_STATES.get(progress.state, "running"), progress.done, progress.total)

    def cancel(self) -> None:
        """Asks the job to stop after the body that it is at. Returns at once; what was made can still be taken."""
        call(lib.anthronet_job_cancel, self._open)

    def wait(self, timeout: Optional[float] = None) -> Progress:
        """Waits until the job has stopped, at most `timeout` seconds; says how far it is then."""
        end = None if timeout is None else time.monotonic() + _arguments.number(timeout, "timeout")
        while True:
            progress = self.progress
            if progress.state != "running" or (end is not None and time.monotonic() >= end):
                return progress
            time.sleep(_PAUSE)

    def take(self, index: int) -> Body:
        """Takes the body of a request, once, as soon as it is there; while the job goes on, too.

        Raises:
            BusyError: it is not made yet.
            CancelledError: it never will be.
            TakenError: it was taken before.
            ArgumentError: there is no such request.
            Error: that request's own.
        """
        place = _arguments.whole(index, "index")
        handle = new_handle(lib.anthronet_job_take, lib.anthronet_body_free, self._open, place)
        return Body._of(handle, self._latent_size)

    @overload
    def results(self, return_errors: Literal[False] = False) -> Iterator[Body]: ...

    @overload
    def results(self, return_errors: bool) -> Iterator[Union[Body, Error]]: ...

    def results(self, return_errors: bool = False) -> Iterator[Union[Body, Error]]:
        """The bodies in the order of their requests, each as soon as it is there; waits in between.

        Ends early when the job is cancelled. Leaves out what was taken before.

        Args:
            return_errors: gives the error of a request that has no body instead of raising it.

        Raises:
            Error: a request's own.
        """
        for index in range(self.progress.total):
            while True:
                try:
                    result: Union[Body, Error] = self.take(index)
                except BusyError:
                    time.sleep(_PAUSE)
                    continue
                except TakenError:
                    break
                except CancelledError:
                    return
                except Error as error:
                    if not return_errors:
                        raise
                    result = error
                yield result
                break

    def __repr__(self) -> str:
        if self.closed:
            return "<Job, closed>"
        state, done, total = self.progress
        return f"<Job {state}, {done} of {total}>"
