using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Linq;
using System.Text.RegularExpressions;
using NUnit.Framework;
using UnityEngine;
using UnityEngine.Rendering;

namespace Anthronet.Tests
{
    /// Memory per character, from the sizes of its meshes.
    [TestFixture]
    public static class MemoryTests
    {
        const double KiB = 1024;

        /// Vertices, triangles, and KiB of vertices, indices and weights.
        static double[] Of(Mesh mesh)
        {
            return new[]
            {
                mesh.vertexCount,
                mesh.Indices.Length / 3,
                4.0 * mesh.Streams.Sum(stream => stream.Length) / KiB,
                mesh.Indices.Length * (mesh.indexFormat == IndexFormat.UInt16 ? 2 : 4) / KiB,
                (8.0 * mesh.Weights.Length + mesh.BonesPerVertex.Length) / KiB,
            };
        }

        [Test(Description = "memory per character is as in the documentation's table")]
        public static void Table()
        {
            var text = File.ReadAllText(Path.Combine(SampleTests.Root, "unity_plugin/Documentation~/index.md"));
            var rows = Regex.Matches(text, @"^\| LOD(\d) \|(.*)\|\r?$", RegexOptions.Multiline).Cast<Match>().ToArray();
            Expect.Equal(4, rows.Length, "rows of the table");
            string all = "", table = "";
            using (var body = AnthroModel.Default.Generate(new AnthroRequest()))
            {
                foreach (var row in rows)
                {
                    var lod = int.Parse(row.Groups[1].Value);
                    var documented = row.Groups[2].Value.Split('|')
                        .Select(cell => double.Parse(cell.Trim().Replace(",", ""), CultureInfo.InvariantCulture)).ToArray();
                    using (var surface = new AnthroMesh(body, lod))
                    {
                        var mesh = AnthroMeshes.Create(surface, body.Joints(), "counted");
                        var found = Of(mesh);
                        var expected = found.Concat(new[] { found[2] + found[3] + found[4] })
                            .Select(value => Math.Round(value)).ToArray();
                        all += "LOD" + lod + " " + string.Join(" ", expected) + "\n";
                        table += "LOD" + lod + " " + string.Join(" ", documented) + "\n";
                        UnityEngine.Object.Destroy(mesh);
                    }
                }
            }
            Expect.Equal(all, table, "the table");
        }

        [Test(Description = "a native body needs no more memory than the documentation says")]
        public static void Bodies()
        {
            var text = File.ReadAllText(Path.Combine(SampleTests.Root, "unity_plugin/Documentation~/index.md"));
            var most = double.Parse(Regex.Match(text, @"native body: at most ([\d.]+) MiB").Groups[1].Value, CultureInfo.InvariantCulture);
            const int Count = 100;
            Func<long> resident = () =>
                4096 * long.Parse(File.ReadAllText("/proc/self/statm").Split(' ')[1], CultureInfo.InvariantCulture);
            using (AnthroModel.Default.Generate(new AnthroRequest()))
            {
            }
            var before = resident();
            var bodies = Enumerable.Range(1, Count).Select(i => AnthroModel.Default.Generate(new AnthroRequest { Seed = (ulong)i })).ToList();
            var each = (resident() - before) / KiB / KiB / Count;
            bodies.ForEach(body => body.Dispose());
            Console.WriteLine("   native body: {0:0.00} MiB", each);
            Expect.That(each <= most, each + " MiB");
        }
    }
}
