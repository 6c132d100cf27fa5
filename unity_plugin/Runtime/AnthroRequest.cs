using System;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// Describes a person to generate: any of the measures in metres, sex, seed. Serialisable by Unity. One thread at
    /// a time may change it.
    /// </summary>
    [Serializable]
    public sealed class AnthroRequest
    {
        [Tooltip("Sex of the person; Any infers it from the measures.")]
        [SerializeField] AnthroSex sex;
        [Tooltip("Values of the measures, metres.")]
        [SerializeField] double[] metres = new double[AnthroMeasures.Count];
        [Tooltip("Which measures are set; the others are filled in.")]
        [SerializeField] bool[] given = new bool[AnthroMeasures.Count];
        [Tooltip("0 for the most likely person with these measures; every other seed is another person with them.")]
        [SerializeField] long seed;
        [Tooltip("How measures that are not set are filled in: most likely values, or random plausible ones chosen by the seed.")]
        [SerializeField] AnthroFill fill;
        [Tooltip("Replaces impossible measures by the nearest possible ones instead of refusing them.")]
        [SerializeField] bool nearest;
        [Tooltip("Explicit latent values; empty derives them from the seed.")]
        [SerializeField] double[] latent = new double[0];

        /// <summary>The sex; `Any` infers it from the measures.</summary>
        public AnthroSex Sex
        {
            get { return sex; }
            set { sex = value; }
        }

        /// <summary>0 for the most likely person with these measures; every other seed is another person with
        /// them.</summary>
        public ulong Seed
        {
            get { return unchecked((ulong)seed); }
            set { seed = unchecked((long)value); }
        }

        /// <summary>How measures that are not set are filled in.</summary>
        public AnthroFill Fill
        {
            get { return fill; }
            set { fill = value; }
        }

        /// <summary>Whether impossible measures are replaced by the nearest possible ones instead of refused.</summary>
        public bool Nearest
        {
            get { return nearest; }
            set { nearest = value; }
        }

        /// <summary>Explicit latent values, `AnthroModel.LatentSize` of them; null derives them from the seed. A
        /// copy.</summary>
        public double[] Latent
        {
            get { return latent == null || latent.Length == 0 ? null : (double[])latent.Clone(); }
            set { latent = value == null ? new double[0] : (double[])value.Clone(); }
        }

        /// <summary>Sets a measure, metres; a name without a side sets both sides.</summary>
        /// <returns>This request.</returns>
        /// <exception cref="AnthroException">There is no measure of this name, or the value is not finite.</exception>
        public AnthroRequest Set(string name, double value)
        {
            int first, second;
            AnthroMeasures.IndicesOf(name, out first, out second);
            if (double.IsNaN(value) || double.IsInfinity(value))
            {
                throw new AnthroException(AnthroError.Request, name + ": expected metres, got " + value);
            }
            metres[first] = metres[second] = value;
            given[first] = given[second] = true;
            return this;
        }

        /// <summary>Unsets a measure, so that it is filled in; a name without a side unsets both sides.</summary>
        /// <returns>This request.</returns>
        /// <exception cref="AnthroException">There is no measure of this name.</exception>
        public AnthroRequest Unset(string name)
        {
            int first, second;
            AnthroMeasures.IndicesOf(name, out first, out second);
            given[first] = given[second] = false;
            return this;
        }

        /// <summary>Whether a measure is set, by its index in `AnthroMeasures.Names`.</summary>
        public bool IsGiven(int measure)
        {
            return given[measure];
        }

        /// <summary>The value of a measure that is or was set, metres, by its index.</summary>
        public double this[int measure]
        {
            get { return metres[measure]; }
        }

        /// <summary>A copy of the request.</summary>
        public AnthroRequest Copy()
        {
            var copy = new AnthroRequest();
            copy.CopyFrom(this);
            return copy;
        }

        /// <summary>Copies all values from another request.</summary>
        public void CopyFrom(AnthroRequest other)
        {
            Library.NotNull(other, "other");
            sex = other.sex;
            metres = (double[])other.metres.Clone();
            given = (bool[])other.given.Clone();
            seed = other.seed;
            fill = other.fill;
            nearest = other.nearest;
            latent = other.latent == null ? new double[0] : (double[])other.latent.Clone();
        }

        /// <summary>
        /// Reads a request from JSON, the same as everywhere in AnthroNet: `{"sex": "female", "measures": {"height":
        /// 1.7}}`.
        /// </summary>
        /// <exception cref="AnthroException">The JSON is not valid, or has unknown keys.</exception>
        public static unsafe AnthroRequest FromJson(string json)
        {
            Library.Ensure();
            ulong length;
            var bytes = Utf8.Bytes(json, "json", out length);
            anthronet_request* made;
            anthronet_error error;
            fixed (byte* data = bytes)
            {
                Library.Check(NativeMethods.anthronet_request_from_json(data, length, &made, &error), &error);
            }
            using (var handle = new RequestHandle(made))
            {
                var request = new AnthroRequest();
                var flags = stackalloc byte[AnthroMeasures.Count];
                fixed (double* metres = request.metres)
                {
                    Library.Check(NativeMethods.anthronet_request_measures(
                        made, metres, flags, AnthroMeasures.Count, &error), &error);
                }
                for (var i = 0; i < AnthroMeasures.Count; i++)
                {
                    request.given[i] = flags[i] != 0;
                }
                anthronet_bytes* text;
                Library.Check(NativeMethods.anthronet_request_to_json(made, &text, &error), &error);
                request.ReadRest(Utf8.TakeText(text));
                return request;
            }
        }

        /// <summary>The request as JSON, as `FromJson` reads it.</summary>
        /// <exception cref="AnthroException">A value of the request is not valid.</exception>
        public unsafe string ToJson()
        {
            using (var handle = Make())
            {
                anthronet_bytes* text;
                anthronet_error error;
                var pointer = (anthronet_request*)handle.DangerousGetHandle();
                Library.Check(NativeMethods.anthronet_request_to_json(pointer, &text, &error), &error);
                return Utf8.TakeText(text);
            }
        }

        /// <summary>Makes the native request. Throws if a value is not valid.</summary>
        internal unsafe RequestHandle Make()
        {
            Library.Ensure();
            anthronet_request* made;
            anthronet_error error;
            Library.Check(NativeMethods.anthronet_request_new(&made, &error), &error);
            var handle = new RequestHandle(made);
            try
            {
                var count = given == null ? 0 : given.Length;
                if (metres == null || metres.Length != count || count != AnthroMeasures.Count)
                {
                    throw new AnthroException(
                        AnthroError.Request, "expected " + AnthroMeasures.Count + " measures, got " + count);
                }
                var flags = stackalloc byte[AnthroMeasures.Count];
                for (var i = 0; i < count; i++)
                {
                    flags[i] = given[i] ? (byte)1 : (byte)0;
                }
                fixed (double* first = metres)
                {
                    Library.Check(NativeMethods.anthronet_request_set_measures(
                        made, first, flags, AnthroMeasures.Count, &error), &error);
                }
                Library.Check(NativeMethods.anthronet_request_set_sex(made, (uint)sex, &error), &error);
                Library.Check(NativeMethods.anthronet_request_set_seed(made, Seed, &error), &error);
                Library.Check(NativeMethods.anthronet_request_set_fill(made, (uint)fill, &error), &error);
                Library.Check(NativeMethods.anthronet_request_set_nearest(made, nearest ? 1u : 0u, &error), &error);
                if (latent != null && latent.Length > 0)
                {
                    fixed (double* first = latent)
                    {
                        Library.Check(NativeMethods.anthronet_request_set_latent(
                            made, first, (uint)latent.Length, &error), &error);
                    }
                }
                return handle;
            }
            catch
            {
                handle.Dispose();
                throw;
            }
        }

        /// <summary>Reads the values that have no native getter from the library's own canonical JSON.</summary>
        void ReadRest(string json)
        {
            var reader = new AnthroJson(json);
            sex = reader.Word("sex") == "female" ? AnthroSex.Female
                : reader.Word("sex") == "male" ? AnthroSex.Male : AnthroSex.Any;
            fill = reader.Word("fill") == "sample" ? AnthroFill.Sample : AnthroFill.Mean;
            nearest = reader.Word("nearest") == "true";
            ulong number;
            Seed = ulong.TryParse(reader.Word("seed"), out number) ? number : 0;
            latent = reader.Numbers("z");
        }
    }
}
