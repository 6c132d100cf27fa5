using System;
using System.Collections.Generic;
using System.Linq;
using NUnit.Framework;
using UnityEngine;
using UnityEngine.Rendering;

namespace Anthronet.Tests
{
    /// Meshes as Unity gets them.
    [TestFixture]
    public static class MeshTests
    {
        [Test(Description = "the left hand is at -X, the face at +Z, the feet are on the floor")]
        public static void Handedness()
        {
            var character = Scene.Character();
            var mesh = character.GetMesh(1);
            var left = character.Rig.Find("hand_l").localToWorldMatrix;
            var right = character.Rig.Find("hand_r").localToWorldMatrix;
            Expect.That(left.m03 < -0.4 && right.m03 > 0.4, "hands at x " + left.m03 + " and " + right.m03);
            Expect.That(left.m13 > 1.2, "a T-pose has its hands at the height of the shoulders, not at " + left.m13);
            // So are the vertices of the left hand.
            var bone = Scene.Joint(character, "hand_l");
            var at = 0;
            var xs = new List<float>();
            for (var v = 0; v < mesh.vertexCount; v++)
            {
                if (mesh.Weights[at].boneIndex == bone)
                {
                    xs.Add(mesh.Position(v).x);
                }
                at += mesh.BonesPerVertex[v];
            }
            Expect.That(xs.Count > 50 && xs.Max() < -0.4, xs.Count + " vertices of the hand up to x " + xs.Max());
            var toes = character.Rig.Find("ball_l").localToWorldMatrix;
            var ankle = character.Rig.Find("foot_l").localToWorldMatrix;
            Expect.That(toes.m23 > ankle.m23 + 0.05, "toes do not point to +Z");
            Expect.Near(0, mesh.bounds.min.y, 0.005, "the floor");
            Expect.Near(1.8, mesh.bounds.max.y, 0.03, "the crown");
            UnityEngine.Object.Destroy(character.gameObject);
        }

        /// Counts the triangles of a part that face along their vertex normals, and those that do not. In Unity's
        /// left-handed space a triangle faces along Cross(b - a, c - a).
        static void Count(Mesh mesh, int part, out int along, out int against, out double volume)
        {
            var of = mesh.GetSubMesh(part);
            along = against = 0;
            volume = 0;
            for (var i = of.indexStart; i < of.indexStart + of.indexCount; i += 3)
            {
                int a = (int)mesh.Indices[i] + of.baseVertex, b = (int)mesh.Indices[i + 1] + of.baseVertex;
                var c = (int)mesh.Indices[i + 2] + of.baseVertex;
                Vector3 pa = mesh.Position(a), pb = mesh.Position(b), pc = mesh.Position(c);
                var front = Vector3.Dot(Vector3.Cross(pb - pa, pc - pa), mesh.Normal(a) + mesh.Normal(b) + mesh.Normal(c));
                along += front > 0 ? 1 : 0;
                against += front < 0 ? 1 : 0;
                volume += Vector3.Dot(pa, Vector3.Cross(pb, pc)) / 6.0;
            }
        }

        [Test(Description = "triangles of all parts are clockwise seen from outside, as Unity expects")]
        public static void Winding()
        {
            foreach (var lod in new[] { 0, 1, 2, 3 })
            {
                using (var body = AnthroModel.Default.Generate(Scene.Request()))
                using (var surface = new AnthroMesh(body, lod))
                {
                    var mesh = AnthroMeshes.Create(surface, body.Joints(), "winding");
                    for (var part = 0; part < mesh.subMeshCount; part++)
                    {
                        int along, against;
                        double volume;
                        Count(mesh, part, out along, out against, out volume);
                        var name = "LOD" + lod + " " + surface.Part(part).name;
                        Expect.That(against * 25 <= along, name + ": " + against + " against, " + along + " along their normals");
                        if (part == 0)
                        {
                            // Closed except for mouth and eyes: about the body's volume, positive if faces point
                            // outwards.
                            Expect.Near(body.Volume, volume, 0.05 * body.Volume, name + ": volume");
                        }
                    }
                    UnityEngine.Object.Destroy(mesh);
                }
            }
        }

        [Test(Description = "normals of eyes point outwards, and each eye is on its side of the head")]
        public static void Eyes()
        {
            var character = Scene.Character();
            var mesh = character.GetMesh(1);
            var names = new List<string>();
            using (var surface = new AnthroMesh(character.Body, 1))
            {
                for (var part = 0; part < surface.PartCount; part++)
                {
                    names.Add(surface.Part(part).name);
                }
            }
            var found = 0;
            foreach (var side in new[] { "eye_l", "eye_r" })
            {
                var middle = Scene.WorldPosition(character.Rig.Find(side));
                var bone = Scene.Joint(character, side);
                Expect.That(side == "eye_l" ? middle.x < -0.02 : middle.x > 0.02, side + " is at " + middle);
                int at = 0, outward = 0, count = 0;
                for (var v = 0; v < mesh.vertexCount; v++)
                {
                    // Only parts of the eyes: eyelids belong to other joints, too.
                    var part = Enumerable.Range(0, mesh.subMeshCount).First(
                        i => v < mesh.GetSubMesh(i).firstVertex + mesh.GetSubMesh(i).vertexCount);
                    if (names[part].StartsWith("Eye") && !names[part].StartsWith("Eyel") && mesh.Weights[at].boneIndex == bone)
                    {
                        count++;
                        outward += Vector3.Dot(mesh.Position(v) - middle, mesh.Normal(v)) > 0 ? 1 : 0;
                    }
                    at += mesh.BonesPerVertex[v];
                }
                found += count;
                Expect.That(count > 20 && outward > 0.8 * count, side + ": " + outward + " of " + count + " look outwards");
            }
            Expect.That(found > 0, "no eyes among " + string.Join(", ", names));
            Scene.Destroy(character);
        }

        [Test(Description = "bind pose x vertex = vertex; bone weights are sorted and their sum is 1")]
        public static void Binding()
        {
            foreach (var lod in new[] { 0, 1, 2, 3 })
            {
                var character = Scene.Character(lod, lod);
                var mesh = character.GetMesh(lod);
                var matrices = character.Rig.Bones
                    .Select((bone, i) => bone.localToWorldMatrix * mesh.bindposes[i]).ToArray();
                var at = 0;
                for (var v = 0; v < mesh.vertexCount; v++)
                {
                    var posed = Vector3.zero;
                    float sum = 0, last = 2;
                    int count = mesh.BonesPerVertex[v];
                    Expect.That(count >= 1 && count <= 4, "vertex " + v + " has " + count + " bones");
                    for (var k = 0; k < count; k++, at++)
                    {
                        var weight = mesh.Weights[at];
                        Expect.That(weight.weight > 0 && weight.weight <= last, "vertex " + v + ": not sorted");
                        last = weight.weight;
                        sum += weight.weight;
                        posed += matrices[weight.boneIndex].MultiplyPoint3x4(mesh.Position(v)) * weight.weight;
                    }
                    Expect.Near(1, sum, 1e-5, "sum of the weights of vertex " + v);
                    Expect.That((posed - mesh.Position(v)).magnitude < 1e-5, "vertex " + v + " moves in the bind pose");
                    Expect.Near(1, mesh.Normal(v).magnitude, 1e-3, "normal of vertex " + v);
                }
                UnityEngine.Object.Destroy(character.gameObject);
            }
        }

        [Test(Description = "sub-meshes cover their vertices and use no others")]
        public static void Parts()
        {
            using (var body = NativeTests.Body())
            using (var surface = new AnthroMesh(body, 1))
            {
                var mesh = AnthroMeshes.Create(surface, body.Joints(), "test");
                Expect.Equal(surface.PartCount, mesh.subMeshCount, "parts");
                Expect.That(Enumerable.Range(0, surface.PartCount).Select(i => surface.Part(i).name).Contains("Teeth"), "teeth");
                var vertex = 0;
                for (var i = 0; i < mesh.subMeshCount; i++)
                {
                    var part = mesh.GetSubMesh(i);
                    Expect.Equal(vertex, part.firstVertex, "first vertex");
                    Expect.Equal(vertex, part.baseVertex, "base vertex");
                    var used = mesh.Indices.Skip(part.indexStart).Take(part.indexCount).Distinct().ToArray();
                    Expect.That(used.Max() < part.vertexCount, "an index beyond part " + i);
                    Expect.Equal(part.vertexCount, used.Length, "used vertices of part " + i);
                    foreach (var index in used)
                    {
                        var p = mesh.Position(vertex + (int)index);
                        var over = Vector3.Max(p - part.bounds.max, part.bounds.min - p);
                        Expect.That(Math.Max(over.x, Math.Max(over.y, over.z)) < 1e-5, "outside of the bounds of part " + i);
                    }
                    vertex += part.vertexCount;
                }
                Expect.Equal(mesh.vertexCount, vertex, "vertices");
                Expect.That(mesh.Streams[1].All(uv => uv >= -0.001f && uv <= 1.001f), "texture coordinates beyond 0 to 1");
                UnityEngine.Object.Destroy(mesh);
            }
        }

        [Test(Description = "indices have 16 bits where they fit, relative to their part's first vertex")]
        public static void Narrow()
        {
            using (var body = AnthroModel.Default.Generate(Scene.Request()))
            {
                foreach (var lod in new[] { 0, 1, 2, 3 })
                {
                    using (var surface = new AnthroMesh(body, lod))
                    {
                        var mesh = AnthroMeshes.Create(surface, body.Joints(), "narrow");
                        var largest = Enumerable.Range(0, surface.PartCount).Max(i => surface.Part(i).vertexCount);
                        var expected = largest <= 65535 ? IndexFormat.UInt16 : IndexFormat.UInt32;
                        Expect.Equal(expected, mesh.indexFormat, "LOD" + lod + " of at most " + largest + " vertices a part");
                        Expect.That(lod == 0 || expected == IndexFormat.UInt16, "LOD" + lod + " does not fit");
                        UnityEngine.Object.Destroy(mesh);
                    }
                }
            }
        }
    }
}
