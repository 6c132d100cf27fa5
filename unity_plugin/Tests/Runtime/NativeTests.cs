using System;
using System.Diagnostics;
using System.IO;
using System.Linq;
using System.Threading;
using Anthronet.Native;
using NUnit.Framework;

namespace Anthronet.Tests
{
    /// The wrappers of the native library without Unity: errors, requests, bodies.
    [TestFixture]
    public static class NativeTests
    {
        internal static AnthroBody Body(ulong seed = 7)
        {
            var request = new AnthroRequest { Sex = AnthroSex.Female, Seed = seed };
            return AnthroModel.Default.Generate(request.Set("height", 1.7).Set("waist_circumference", 0.8));
        }

        [Test(Description = "the error of a missing library or one of another release has the file")]
        public static void Missing()
        {
            var error = Library.Missing(new DllNotFoundException("anthronet"));
            Expect.That(error.Message.Contains("Packages/com.anthronet.unity/Runtime/Plugins/"),
                error.Message);
            Library.CheckVersion(NativeMethods.ANTHRONET_ABI_VERSION);
            var version = Expect.Throws<NotSupportedException>(() => Library.CheckVersion(99), "version 99");
            Expect.That(version.Message.Contains("99") && version.Message.Contains("1"), version.Message);
        }

        [Test(Description = "library and package have the same version")]
        public static unsafe void Version()
        {
            anthronet_text version;
            anthronet_error error;
            Library.Check(NativeMethods.anthronet_version(&version, &error), &error);
            Expect.Equal(AnthroPackage.Version, Utf8.Text(version), "version");
        }

        [Test(Description = "measures have the library's names and order")]
        public static unsafe void Measures()
        {
            Expect.Equal((uint)AnthroMeasures.Count, NativeMethods.anthronet_measure_count(), "count");
            for (var i = 0u; i < AnthroMeasures.Count; i++)
            {
                anthronet_text name;
                anthronet_error error;
                Library.Check(NativeMethods.anthronet_measure_name(i, &name, &error), &error);
                Expect.Equal(Utf8.Text(name), AnthroMeasures.Names[(int)i], "measure " + i);
                double min, max;
                AnthroModel.Default.MeasureRange((int)i, out min, out max);
                Expect.That(0 < min && min < max && max < 3, AnthroMeasures.Names[(int)i] + ": " + min + " to " + max);
            }
        }

        [Test(Description = "requests survive a round trip through JSON")]
        public static void Requests()
        {
            var request = new AnthroRequest
            {
                Sex = AnthroSex.Male, Seed = ulong.MaxValue, Fill = AnthroFill.Sample, Nearest = true,
            };
            request.Set("height", 1.83).Set("arm_length", 0.35).Set("foot_width_right", 0.1);
            var latent = new double[AnthroModel.Default.LatentSize];
            latent[0] = 0.1 + 0.2;
            latent[3] = -1e-7;
            request.Latent = latent;
            var again = AnthroRequest.FromJson(request.ToJson());
            Expect.Equal(request.ToJson(), again.ToJson(), "JSON");
            Expect.Equal(ulong.MaxValue, again.Seed, "seed");
            Expect.That(again.IsGiven(AnthroMeasures.IndexOf("arm_length_left")), "left arm");
            Expect.That(again.IsGiven(AnthroMeasures.IndexOf("arm_length_right")), "right arm");
            Expect.That(!again.IsGiven(AnthroMeasures.IndexOf("foot_width_left")), "left foot");
            Expect.That(again.Latent.SequenceEqual(latent), "latent");
            Expect.That(!again.Unset("height").Copy().IsGiven(3), "opened");
            Expect.Equal(1.83, request[3], "the first is another one");
            Expect.That(new AnthroRequest().Latent == null, "no latent");
        }

        [Test(Description = "errors have their code and say why")]
        public static void Errors()
        {
            var model = AnthroModel.Default;
            Expect.Code(AnthroError.Request, "shoe_size", () => new AnthroRequest().Set("shoe_size", 1), "unknown measure");
            Expect.Code(AnthroError.Request, "height", () => new AnthroRequest().Set("height", double.NaN), "no number");
            Expect.Code(AnthroError.Request, "height", () => model.Generate(new AnthroRequest().Set("height", 170)), "cm");
            Expect.Code(AnthroError.Request, "10 numbers", () => model.Generate(new AnthroRequest { Latent = new double[2] }),
                "latent");
            Expect.Code(AnthroError.Request, "", () => AnthroRequest.FromJson("{"), "JSON");
            Expect.Code(AnthroError.Request, "wa\u00efst", () => AnthroRequest.FromJson("{\"measures\":{\"wa\u00efst\":1}}"),
                "UTF-8 there and back");
            Expect.Code(AnthroError.Io, "nowhere", () => AnthroModel.Open("/nowhere/model\u20ac"), "model");
            Expect.Code(AnthroError.Model, "", () => AnthroModel.Open(new byte[0]), "empty model");
            Expect.Code(AnthroError.Enum, "sex", () => model.Generate(new AnthroRequest { Sex = (AnthroSex)9 }), "sex");
            Expect.Code(AnthroError.Index, "", () => { double a, b; model.MeasureRange(AnthroMeasures.Count, out a, out b); }, "range");
            Expect.Throws<ArgumentNullException>(() => model.Generate(null), "no request");
            Expect.Throws<ArgumentNullException>(() => AnthroModel.Open((string)null), "no path");
            foreach (var given in new Action[]
            {
                () => AnthroClip.Builtin("walk", null), () => new AnthroSkinner(null), () => new AnthroMesh(null, 0),
                () => new AnthroCrowdSkin(null, 1), () => new AnthroCrowdSkin(new AnthroSkinner[1], 1),
                () => model.StartJob(new AnthroRequest[1]), () => AnthroFactory.CreateAsync(null),
                () => AnthroFactory.CreateAsync(new AnthroRequest[1]), () => AnthroMeshes.Create((AnthroMesh)null, new AnthroJoint[0], "x"),
                () => new AnthroRequest().CopyFrom(null), () => AnthroRequest.FromJson(null),
            })
            {
                var missing = Expect.Throws<ArgumentNullException>(() => given(), "nothing given");
                Expect.That(!string.IsNullOrEmpty(missing.ParamName) && missing.ParamName != "handle", "which one: " + missing);
            }
            Expect.Throws<OverflowException>(() => { double a, b; model.MeasureRange(-1, out a, out b); }, "negative index");
            using (var body = Body())
            {
                Expect.Code(AnthroError.Size, AnthroMeasures.Count.ToString(), () => body.Measures(new AnthroMeasureReport[2]), "few reports");
                Expect.Code(AnthroError.Size, "", () => body.Joints(new AnthroJoint[1]), "few joints");
                Expect.Code(AnthroError.Size, "", () => body.Joints(new AnthroJoint[0]), "no joints");
                Expect.Code(AnthroError.Request, "fly", () => AnthroClip.Builtin("fly", body), "clip");
                Expect.Code(AnthroError.Request, "docx", () => body.ToBytes("docx"), "format");
                Expect.Throws<AnthroException>(() => new AnthroMesh(body, 4), "level of detail");
                using (var clip = AnthroClip.Builtin("walk", body))
                {
                    Expect.Code(AnthroError.Request, "", () => clip.Sample(double.NaN, AnthroWrap.Loop,
                        new AnthroTransform[clip.JointCount]), "no time");
                }
            }
        }

        [Test(Description = "bodies have the requested measures")]
        public static void Bodies()
        {
            using (var body = Body())
            {
                var reports = body.Measures();
                Expect.Near(1.7, reports[3].obtained, 1e-4, "height");
                Expect.That(reports[3].Given && !reports[4].Given, "given");
                Expect.Equal(AnthroSex.Female, body.Sex, "sex");
                Expect.Equal(7ul, body.Seed, "seed");
                Expect.That(body.Converged && body.SolveResidual < 1e-4, "solve " + body.SolveResidual);
                Expect.That(body.Mass > 40 && body.Mass < 100 && body.Bmi > 15 && body.Volume > 0.03, "mass " + body.Mass);
                Expect.That(body.ReportJson.Contains("\"waist_circumference\""), "report");
                var latent = new double[AnthroModel.Default.LatentSize];
                body.Latent(latent);
                Expect.That(latent.Any(z => z != 0), "latent");
            }
            using (var half = AnthroModel.Default.Interpolate(new AnthroRequest { Sex = AnthroSex.Male }.Set("height", 1.6),
                new AnthroRequest { Sex = AnthroSex.Male }.Set("height", 1.8), 0.5))
            {
                Expect.Near(1.7, half.Measures()[3].obtained, 1e-3, "half the way");
            }
        }
    }
}
