using System;
using Anthronet.Native;
using UnityEngine;

namespace Anthronet
{
    /// <summary>
    /// A person to be made: any of the 36 measures in metres, sex, seed. Unity serialises it with whatever holds it.
    /// One thread at a time may change it.
    /// </summary>
    [Serializable]
    public sealed class AnthroRequest
    {
        [SerializeField] AnthroSex sex;
        [SerializeField] double[] metres = new double[AnthroMeasures.Count];
        [SerializeField] bool[] given = new bool[AnthroMeasures.Count];
        [SerializeField] long seed;
        [SerializeField] AnthroFill fill;
        [SerializeField] bool nearest;
        [SerializeField] double[] latent = new double[0];

        /// <summary>The sex; `Any` leaves it to the measures.</summary>
        public AnthroSex Sex
        {
            get { return sex; }
            set { sex = value; }
        }

        /// <summary>0 for the likeliest person with these measures, any other for one of them.</summary>
        public ulong Seed
        {
            get { return unchecked((ulong)seed); }
            set { seed = unchecked((long)value); }
        }

        /// <summary>How open measures are filled.</summary>
        public AnthroFill Fill
        {
            get { return fill; }
            set { fill = value; }
        }

        /// <summary>Whether the nearest person is taken where nobody has these measures.</summary>
        public bool Nearest
        {
            get { return nearest; }
            set { nearest = value; }
        }

        /// <summary>The latent numbers by hand, `AnthroModel.LatentSize` of them; null leaves them to the seed. A copy.
        /// </summary>
        public double[] Latent
        {
            get { return latent == null || latent.Length == 0 ? null : (double[])latent.Clone(); }
            set { latent = value == null ? new double[0] : (double[])value.Clone(); }
        }

        /// <summary>Gives a measure, metres; a name without its side gives both sides.</summary>
        /// <returns>This request.</returns>
        /// <exception cref="AnthroException">There is no such measure, or the number is not finite.</exception>
        public AnthroRequest Set(string name, double value)
        {
            int first, second;
            AnthroMeasures.Sides(name, out first, out second);
            if (double.IsNaN(value) || double.IsInfinity(value))
            {
                throw new AnthroException(AnthroError.Request, name + ": expected metres, got " + value);
            }
            metres[first] = metres[second] = value;
            given[first] = given[second] = true;
            return this;
        }

        /// <summary>Leaves a measure open; a name without its side opens both sides.</summary>
        /// <returns>This request.</returns>
        /// <exception cref="AnthroException">There is no such measure.</exception>
        public AnthroRequest Open(string name)
        {
            int first, second;
            AnthroMeasures.Sides(name, out first, out second);
            given[first] = given[second] = false;
            return this;
        }

        /// <summary>Whether a measure is given, by its place in `AnthroMeasures.Names`.</summary>
        public bool IsGiven(int measure)
        {
            return given[measure];
        }

        /// <summary>What a measure is or was given as, metres, by its place.</summary>
        public double this[int measure]
        {
            get { return metres[measure]; }
        }

        /// <summary>Another request that asks for the same.</summary>
        public AnthroRequest Copy()
        {
            var copy = new AnthroRequest();
            copy.Take(this);
            return copy;
        }

        /// <summary>Makes this request ask for what another does.</summary>
        public void Take(AnthroRequest other)
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
        /// A request from JSON, as all parts of AnthroNet read it: `{"sex": "female", "measures": {"height": 1.7}}`.
        /// </summary>
        /// <exception cref="AnthroException">The text is not such JSON, or names what there is not.</exception>
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

        /// <summary>The request as JSON in the form that `FromJson` reads.</summary>
        /// <exception cref="AnthroException">It holds what no request may.</exception>
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

        /// <summary>The library's request. Refused where a field holds what no request may.</summary>
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

        /// <summary>Reads what only the library's own JSON tells: it is canonical, with these keys at its top.</summary>
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
