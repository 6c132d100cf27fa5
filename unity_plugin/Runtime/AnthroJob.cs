using System;
using Anthronet.Native;

namespace Anthronet
{
    /// <summary>State of a job.</summary>
    public enum AnthroJobState
    {
        /// <summary>Bodies are being generated.</summary>
        Running = 0,
        /// <summary>Every request has a body or an error.</summary>
        Done = 1,
        /// <summary>Cancelled and stopped; finished bodies can still be taken.</summary>
        Cancelled = 2,
    }

    /// <summary>Requests that worker threads of the library turn into bodies. Any thread may poll, cancel and
    /// take.</summary>
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

        /// <summary>State and number of finished requests. Returns immediately; allocates no managed memory.</summary>
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

        /// <summary>Cancels the job after the current body. Returns immediately.</summary>
        public void Cancel()
        {
            using (var held = new Held(handle))
            {
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_job_cancel((anthronet_job*)held.Pointer, &error), &error);
            }
        }

        /// <summary>Takes the body of a request; possible once per request.</summary>
        /// <exception cref="AnthroException">The request's own error; `Busy` while it is not finished, `Cancelled` if the
        /// job was cancelled before it, `Taken` if it was taken already.</exception>
        public AnthroBody Take(int index)
        {
            AnthroBody body;
            AnthroException error;
            if (!TryTake(index, out body, out error))
            {
                throw error ?? new AnthroException(AnthroError.Busy, "the body is still being generated");
            }
            return body;
        }

        /// <summary>Takes the body of a request if it is finished.</summary>
        /// <returns>Whether there was a body; if not, `error` has the reason, or is null while the body is being
        /// generated.</returns>
        public bool TryTake(int index, out AnthroBody body, out AnthroException error)
        {
            using (var held = new Held(handle))
            {
                anthronet_body* made;
                anthronet_error nativeError;
                var status = NativeMethods.anthronet_job_take(
                    (anthronet_job*)held.Pointer, checked((uint)index), &made, &nativeError);
                body = status == NativeMethods.ANTHRONET_OK ? new AnthroBody(made) : null;
                error = status == NativeMethods.ANTHRONET_OK || status == NativeMethods.ANTHRONET_ERROR_BUSY
                    ? null : new AnthroException((AnthroError)status, Utf8.ZeroTerminated(nativeError.message, 512));
                return body != null;
            }
        }

        /// <summary>Cancels the job, waits for the current body, and frees the native memory.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
