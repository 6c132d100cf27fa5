using System;
using System.IO;
using System.Linq;
using System.Security.Cryptography;
using NUnit.Framework;
using UnityEngine;

namespace Anthronet.Tests
{
    /// The same bytes as from Rust. `ffi/tests/same_bytes.rs` says what is hashed, and writes the list of hashes.
    [TestFixture]
    public static class SameBytesTests
    {
        static string[] Lines(string name)
        {
            var folder = Environment.GetEnvironmentVariable("ANTHRONET_SAME_BYTES");
            Expect.That(!string.IsNullOrEmpty(folder), "ANTHRONET_SAME_BYTES is not set: `cargo xtask test --only unity` sets it");
            var lines = File.ReadAllLines(Path.Combine(folder, name));
            Expect.That(lines.Length >= 200, "only " + lines.Length + " lines in " + name);
            return lines;
        }

        static string Hex(HashAlgorithm sha)
        {
            sha.TransformFinalBlock(new byte[0], 0, 0);
            return string.Concat(sha.Hash.Select(b => b.ToString("x2")));
        }

        static void Add(HashAlgorithm sha, Array numbers)
        {
            var bytes = new byte[Buffer.ByteLength(numbers)];
            Buffer.BlockCopy(numbers, 0, bytes, 0, bytes.Length);
            sha.TransformBlock(bytes, 0, bytes.Length, null, 0);
        }

        [Test(Description = "same bytes as from Rust for 200 requests: files, and filled meshes in Unity's left-handed space with bind poses and joints")]
        public static void Same()
        {
            var requests = Lines("requests.jsonl");
            string[] files = Lines("sha256.txt"), meshes = Lines("unity_sha256.txt");
            for (var i = 0; i < requests.Length; i++)
            {
                string file, held;
                try
                {
                    using (var body = AnthroModel.Default.Generate(AnthroRequest.FromJson(requests[i])))
                    using (var surface = new AnthroMesh(body, i % 4))
                    using (var walk = i % 10 == 3 ? AnthroClip.Builtin("walk", body) : null)
                    {
                        var clips = walk == null ? new AnthroClip[0] : new[] { walk };
                        file = Hash(body.ToBytes("glb", i % 4, clips));
                        var joints = body.Joints();
                        var mesh = AnthroMeshes.Create(surface, joints, "hashed");
                        held = Hash(mesh, joints);
                        UnityEngine.Object.Destroy(mesh);
                    }
                }
                catch (AnthroException error)
                {
                    file = held = "error " + (int)error.Code;
                }
                Expect.Equal(files[i], file, "file of request " + i);
                Expect.Equal(meshes[i], held, "mesh of request " + i);
            }
        }

        static string Hash(byte[] bytes)
        {
            using (var sha = SHA256.Create())
            {
                Add(sha, bytes);
                return Hex(sha);
            }
        }

        /// Hashes the mesh part by part, then bind poses and joints.
        static string Hash(Mesh mesh, AnthroJoint[] joints)
        {
            using (var sha = SHA256.Create())
            {
                var influence = 0;
                for (var part = 0; part < mesh.subMeshCount; part++)
                {
                    var of = mesh.GetSubMesh(part);
                    var rows = new float[6 * of.vertexCount];
                    Array.Copy(mesh.Streams[0], 6 * of.firstVertex, rows, 0, rows.Length);
                    Add(sha, rows);
                    rows = new float[2 * of.vertexCount];
                    Array.Copy(mesh.Streams[1], 2 * of.firstVertex, rows, 0, rows.Length);
                    Add(sha, rows);
                    var indices = new uint[of.indexCount];
                    Array.Copy(mesh.Indices, of.indexStart, indices, 0, indices.Length);
                    Add(sha, indices);
                    var bones = new ushort[4 * of.vertexCount];
                    var weights = new float[4 * of.vertexCount];
                    for (var v = 0; v < of.vertexCount; v++)
                    {
                        for (var k = 0; k < mesh.BonesPerVertex[of.firstVertex + v]; k++, influence++)
                        {
                            bones[4 * v + k] = (ushort)mesh.Weights[influence].boneIndex;
                            weights[4 * v + k] = mesh.Weights[influence].weight;
                        }
                    }
                    Add(sha, bones);
                    Add(sha, weights);
                }
                for (var joint = 0; joint < joints.Length; joint++)
                {
                    var m = mesh.bindposes[joint];
                    var numbers = new float[23];
                    for (var k = 0; k < 16; k++)
                    {
                        numbers[k] = m[k % 4, k / 4];
                    }
                    var local = joints[joint].parentFromJoint;
                    Array.Copy(new[] { local.rotation.x, local.rotation.y, local.rotation.z, local.rotation.w,
                        local.translation.x, local.translation.y, local.translation.z }, 0, numbers, 16, 7);
                    Add(sha, numbers);
                }
                return Hex(sha);
            }
        }
    }
}
