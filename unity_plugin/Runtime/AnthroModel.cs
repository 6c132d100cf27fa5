using System;
using System.Collections.Generic;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>A trained model, which generates bodies from requests. Immutable; any number of threads may use
    /// it.</summary>
    public sealed unsafe class AnthroModel : IDisposable
    {
        static readonly object gate = new object();
        static AnthroModel shared;

        readonly ModelHandle handle;

        AnthroModel(anthronet_model* pointer)
        {
            handle = new ModelHandle(pointer);
        }

        /// <summary>The model embedded in the native library, opened once and shared. Do not dispose it; use
        /// `ReleaseDefault`.</summary>
        /// <exception cref="DllNotFoundException">The native library is missing.</exception>
        public static AnthroModel Default
        {
            get
            {
                lock (gate)
                {
                    return shared ?? (shared = OpenEmbedded());
                }
            }
        }

        /// <summary>Frees the model of `Default`; the next use opens it again. Bodies and jobs stay valid.</summary>
        public static void ReleaseDefault()
        {
            lock (gate)
            {
                if (shared != null)
                {
                    shared.Dispose();
                    shared = null;
                }
            }
        }

        // With domain reload disabled, static fields survive from the previous play session.
        [RuntimeInitializeOnLoadMethod(RuntimeInitializeLoadType.SubsystemRegistration)]
        static void Restart()
        {
            ReleaseDefault();
        }

        /// <summary>Opens the model embedded in the native library.</summary>
        public static AnthroModel OpenEmbedded()
        {
            Library.Ensure();
            anthronet_model* made;
            anthronet_error error;
            Library.Check(NativeMethods.anthronet_model_open_embedded(&made, &error), &error);
            return new AnthroModel(made);
        }

        /// <summary>Opens a model file.</summary>
        /// <exception cref="AnthroException">The file does not exist or is damaged.</exception>
        public static AnthroModel Open(string path)
        {
            Library.Ensure();
            ulong length;
            anthronet_model* made;
            anthronet_error error;
            fixed (byte* data = Utf8.Bytes(path, "path", out length))
            {
                Library.Check(NativeMethods.anthronet_model_open_path(data, length, &made, &error), &error);
            }
            return new AnthroModel(made);
        }

        /// <summary>Opens a model from the bytes of a model file, such as those of a TextAsset.</summary>
        /// <exception cref="AnthroException">The bytes are not a valid model file.</exception>
        public static AnthroModel Open(byte[] bytes)
        {
            Library.NotNull(bytes, "bytes");
            Library.Ensure();
            anthronet_model* made;
            anthronet_error error;
            // `fixed` gives null for an empty array.
            fixed (byte* data = bytes.Length == 0 ? new byte[1] : bytes)
            {
                Library.Check(
                    NativeMethods.anthronet_model_open_memory(data, (ulong)bytes.Length, &made, &error), &error);
            }
            return new AnthroModel(made);
        }

        /// <summary>Number of latent values of a body.</summary>
        public int LatentSize
        {
            get
            {
                return Library.Number(handle, (pointer, size, error) =>
                    NativeMethods.anthronet_model_latent_size((anthronet_model*)pointer, size, error));
            }
        }

        /// <summary>Description of the model as JSON: measures with definitions and ranges, joints, versions,
        /// scores.</summary>
        public string InfoJson
        {
            get
            {
                return Library.BytesText(handle, (pointer, bytes, error) =>
                    NativeMethods.anthronet_model_info((anthronet_model*)pointer, bytes, error));
            }
        }

        /// <summary>The smallest and the largest value that a request may have for a measure, metres.</summary>
        public void MeasureRange(int measure, out double min, out double max)
        {
            using (var held = new Held(handle))
            {
                double low, high;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_model_measure_range(
                    (anthronet_model*)held.Pointer, checked((uint)measure), &low, &high, &error), &error);
                min = low;
                max = high;
            }
        }

        /// <summary>Generates the body that a request describes. May be called from any thread.</summary>
        /// <exception cref="AnthroException">The request is refused; the message says why.</exception>
        public AnthroBody Generate(AnthroRequest request)
        {
            using (var asked = Library.NotNull(request, "request").Make())
            using (var held = new Held(handle))
            {
                anthronet_body* made;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_generate(
                    (anthronet_model*)held.Pointer, (anthronet_request*)asked.DangerousGetHandle(), &made, &error),
                    &error);
                return new AnthroBody(made);
            }
        }

        /// <summary>Generates a body between two requests: `t` 0 is the first, 1 the second.</summary>
        public AnthroBody Interpolate(AnthroRequest from, AnthroRequest to, double t)
        {
            using (var first = Library.NotNull(from, "from").Make())
            using (var second = Library.NotNull(to, "to").Make())
            using (var held = new Held(handle))
            {
                anthronet_body* made;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_interpolate(
                    (anthronet_model*)held.Pointer, (anthronet_request*)first.DangerousGetHandle(),
                    (anthronet_request*)second.DangerousGetHandle(), t, &made, &error), &error);
                return new AnthroBody(made);
            }
        }

        /// <summary>Starts generating the bodies of requests, in order, on worker threads of the library.</summary>
        public AnthroJob StartJob(IList<AnthroRequest> requests)
        {
            var asked = new RequestHandle[Library.NotNull(requests, "requests").Count];
            try
            {
                // One extra entry: `fixed` gives null for an empty array.
                var pointers = new IntPtr[requests.Count + 1];
                for (var i = 0; i < asked.Length; i++)
                {
                    asked[i] = Library.NotNull(requests[i], "requests").Make();
                    pointers[i] = asked[i].DangerousGetHandle();
                }
                using (var held = new Held(handle))
                fixed (IntPtr* first = pointers)
                {
                    anthronet_job* made;
                    anthronet_error error;
                    Library.Check(NativeMethods.anthronet_job_start(
                        (anthronet_model*)held.Pointer, (anthronet_request**)first, (uint)asked.Length, &made, &error),
                        &error);
                    return new AnthroJob(made, asked.Length);
                }
            }
            finally
            {
                foreach (var one in asked)
                {
                    if (one != null)
                    {
                        one.Dispose();
                    }
                }
            }
        }

        /// <summary>Frees the native memory. Bodies and jobs made by the model stay valid.</summary>
        public void Dispose()
        {
            handle.Dispose();
        }
    }
}
