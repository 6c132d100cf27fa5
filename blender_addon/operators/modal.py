# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators whose work takes long: in slices with a progress bar if a user started them in a window, else all at once."""

import time
import traceback

import bpy

from .. import library

#: Length of a slice of work, during which the window does not respond, and of the pause before the next one; seconds.
_SLICE = 0.03
#: Time to wait before asking again if the work waits for another thread; seconds.
_WAIT = 0.001


class SlicedWork:
    """Work that can be done in slices: a generator that yields its progress, 0 to 1, or None while it waits for a thread."""

    def __init__(self, generator):
        self._generator = generator
        self.progress = 0.0
        self.done = False

    def run_slice(self, seconds=_SLICE):
        """Works for about this long and returns whether everything is done. After an exception the work is over."""
        end = time.perf_counter() + seconds
        while not self.done:
            try:
                progress = next(self._generator)
            except StopIteration:
                self.done, self.progress = True, 1.0
                break
            except BaseException:
                self.done = True
                raise
            if progress is None:
                time.sleep(_WAIT)
            else:
                self.progress = progress
            if time.perf_counter() >= end:
                break
        return self.done

    def run_to_end(self):
        """Does all the work."""
        while not self.run_slice(seconds=float("inf")):
            pass

    def close(self):
        """Stops the work. The generator restores what it changed temporarily."""
        self._generator.close()
        self.done = True


class ModalOperator:
    """Mix-in for operators with long work.

    A subclass has ``work(context)``, a generator as :class:`SlicedWork` needs it. That sets ``changed`` as soon as it has
    changed the scene, so that there is an undo step even if the work is stopped or fails."""

    changed = False
    _work = None
    _timer = None

    def execute(self, context):
        """Does the work: in slices if the operator was invoked in a window, else at once."""
        self.changed = False
        self._work = SlicedWork(self.work(context))
        if self.options.is_invoke and not self.options.is_repeat and not bpy.app.background:
            return self._start_modal(context)
        try:
            self._work.run_to_end()
        except library.failures() as error:
            self.report({"ERROR"}, str(error))
            return self._interrupted_result()
        finally:
            self._work.close()
        return {"FINISHED"}

    def modal(self, context, event):
        """Does a slice of work on each timer event; Esc stops the work."""
        try:
            if event.type == "ESC":
                self._end_modal(context)
                self.report({"INFO"}, f"Stopped at {self._work.progress:.0%}")
                return self._interrupted_result()
            if event.type != "TIMER":
                return {"RUNNING_MODAL"}
            if not self._work.run_slice():
                context.window_manager.progress_update(self._work.progress)
                context.workspace.status_text_set(f"{self.bl_label}: {self._work.progress:.0%}   Esc: Stop")
                return {"RUNNING_MODAL"}
            self._end_modal(context)
            return {"FINISHED"}
        except Exception as error:
            # Also after a programming error: the timer and the progress bar must not stay.
            self._end_modal(context)
            if not isinstance(error, library.failures()):
                traceback.print_exc()
            self.report({"ERROR"}, str(error) or type(error).__name__)
            return self._interrupted_result()

    def cancel(self, context):
        """Stops the work when Blender quits."""
        self._end_modal(context)

    def _start_modal(self, context):
        manager = context.window_manager
        self._timer = manager.event_timer_add(_SLICE, window=context.window)
        manager.progress_begin(0.0, 1.0)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def _end_modal(self, context):
        try:
            self._work.close()
        finally:
            if self._timer is not None:
                context.window_manager.event_timer_remove(self._timer)
                self._timer = None
                context.window_manager.progress_end()
                context.workspace.status_text_set(None)

    def _interrupted_result(self):
        # FINISHED pushes an undo step.
        return {"FINISHED"} if self.changed else {"CANCELLED"}


class ModalOperatorWithoutDialog(ModalOperator):
    """The same for operators that start at once when they are invoked."""

    def invoke(self, context, _event):
        """Starts the work. Blender reports an invocation only to operators that have this method."""
        return self.execute(context)
