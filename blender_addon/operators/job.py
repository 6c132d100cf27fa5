# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work in slices: with progress and Esc in a window, at once without one."""

import time
import traceback

import bpy

from .. import library

#: How long a slice of work may keep the window waiting, seconds.
_SLICE = 0.03
_PAUSE = 0.001


class Steps:
    """Work that is done bit by bit: a generator that yields how far it is, 0 to 1, or None while it waits for others."""

    def __init__(self, work):
        self._work = work
        self.progress = 0.0
        self.done = False

    def step(self, seconds=_SLICE):
        """Works for about as long; whether all is done. Raises what the work raises, and then it is over."""
        end = time.perf_counter() + seconds
        while not self.done:
            try:
                progress = next(self._work)
            except StopIteration:
                self.done, self.progress = True, 1.0
                break
            except BaseException:
                self.done = True
                raise
            if progress is None:
                time.sleep(_PAUSE)
            else:
                self.progress = progress
            if time.perf_counter() >= end:
                break
        return self.done

    def finish(self):
        """Works to the end."""
        while not self.step(seconds=float("inf")):
            pass

    def close(self):
        """Ends the work where it is; it puts back what it borrowed."""
        self._work.close()
        self.done = True


class ModalJob:
    """An operator with long work. A subclass has ``work(context)``, a generator as :class:`Steps` wants it, which sets
    ``changed`` once the scene is another one, so that there is something to undo."""

    changed = False
    _steps = None
    _timer = None

    def execute(self, context):
        """Does the work: in slices for a user who is waiting before a window, else at once."""
        self.changed = False
        self._steps = Steps(self.work(context))
        if self.options.is_invoke and not self.options.is_repeat and not bpy.app.background:
            return self._start(context)
        try:
            self._steps.finish()
        except library.failures() as error:
            self.report({"ERROR"}, str(error))
            return self._result()
        finally:
            self._steps.close()
        return {"FINISHED"}

    def modal(self, context, event):
        """A slice of work a tick; Esc ends it."""
        try:
            if event.type == "ESC":
                self._end(context)
                self.report({"INFO"}, f"Stopped at {self._steps.progress:.0%}")
                return self._result()
            if event.type != "TIMER":
                return {"RUNNING_MODAL"}
            if not self._steps.step():
                context.window_manager.progress_update(self._steps.progress)
                context.workspace.status_text_set(f"{self.bl_label}: {self._steps.progress:.0%}   Esc: Stop")
                return {"RUNNING_MODAL"}
            self._end(context)
            return {"FINISHED"}
        except Exception as error:
            # Whatever it is, no timer may outlive it.
            self._end(context)
            if not isinstance(error, library.failures()):
                traceback.print_exc()
            self.report({"ERROR"}, str(error) or type(error).__name__)
            return self._result()

    def cancel(self, context):
        """Blender ends: stop the work."""
        self._end(context)

    def _start(self, context):
        manager = context.window_manager
        self._timer = manager.event_timer_add(_SLICE, window=context.window)
        manager.progress_begin(0.0, 1.0)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def _end(self, context):
        try:
            self._steps.close()
        finally:
            if self._timer is not None:
                context.window_manager.event_timer_remove(self._timer)
                self._timer = None
                context.window_manager.progress_end()
                context.workspace.status_text_set(None)

    def _result(self):
        # What was done already can be undone.
        return {"FINISHED"} if self.changed else {"CANCELLED"}
