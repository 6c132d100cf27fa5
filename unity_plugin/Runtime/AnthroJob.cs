using System;
using Anthronet.Native;

namespace Anthronet
{
    /// <summary>How far a job is.</summary>
    public enum AnthroJobState
    {
        /// <summary>Bodies are still being made.</summary>
        Running = 0,
        /// <summary>Every request has its body or its error.</summary>
        Done = 1,
        /// <summary>Cancelled and stopped; what was made before can be taken.</summary>
        Cancelled = 2,
    }

    /// <summary>Requests that the library is making into bodies. Any thread may poll, cancel and take.</summary>
    public sealed unsafe class AnthroJob : IDisposable
    {
        readonly BodyJobHandle handle;

        internal AnthroJob(anthronet_job* pointer, int count)
        {
            handle = new BodyJobHandle(pointer);
            Count = count;
        }

        /// <summary>Number of requests.</summary>
        public int Count { get; private set; }

        /// <summary>How far it is. Returns at once and makes no garbage.</summary>
        public AnthroJobState Poll(out int done)
        {
            using (var held = new Held(handle))
            {
                anthronet_job_progress progress;
                progress.struct_size = (uint)sizeof(anthronet_job_progress);
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_job_poll(
                    (anthronet_job*)held.Pointer, &progress, &error), &error);
                done = (int)progress.done;
                return (AnthroJobState)progress.state;
            }
        }

        /// <summary>Asks it to stop after the body that it is at. Returns at once.</summary>
        public void Cancel()
        {
            using (var held = new Held(handle))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_job_cancel((anthronet_job*)held.Pointer, &error), &error);
            }
        }

        /// <summary>Takes the body of a request, once.</summary>
        /// <exception cref="AnthroException">The error of that request; `Busy` before there is one, `Cancelled` when there
        /// will be none, `Taken` the second time.</exception>
        public AnthroBody Take(int index)
        {
            AnthroBody body;
            AnthroException error;
            if (!TryTake(index, out body, out error))
            {
                throw error ?? new AnthroException(AnthroError.Busy, "the body is still being made");
            }
            return body;
        }

        /// <summary>Takes the body of a request if it is there.</summary>
        /// <returns>Whether it was; else `error` says why, or is null where it is still being made.</returns>
        public bool TryTake(int index, out AnthroBody body, out AnthroException error)
        {
            using (var held = new Held(handle))
            {
                anthronet_body* made;
                anthronet_error said;
                var status = NativeMethods.anthronet_job_take(
                    (anthronet_job*)held.Pointer, checked((uint)index), &made, &said);
                body = status == NativeMethods.ANTHRONET_OK ? new AnthroBody(made) : null;
                error = status == NativeMethods.ANTHRONET_OK || status == NativeMethods.ANTHRONET_ERROR_BUSY
                    ? null : new AnthroException((AnthroError)status, Utf8.Ended(said.message, 512));
                return body != null;
            }
        }

        /// <summary>Cancels it, waits for the body that it is at, and frees it.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
