using System;
using System.Linq;
using System.Runtime.InteropServices;
using NUnit.Framework;
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;
using Unity.Jobs;
using UnityEngine;

namespace Anthronet.Tests
{
    /// Skinning on the CPU.
    [TestFixture]
    public static unsafe class SkinTests
    {
        const double Seconds = 0.35;

        /// Positions and normals of a part by Unity's formula, from the joints' transforms.
        static void Formula(AnthroCharacter character, Mesh mesh, int part, Vector3[] positions, Vector3[] normals)
        {
            var matrices = character.Rig.Bones.Select((bone, i) => bone.localToWorldMatrix * mesh.bindposes[i]).ToArray();
            var of = mesh.GetSubMesh(part);
            var at = mesh.BonesPerVertex.Take(of.firstVertex).Sum(count => count);
            for (var v = 0; v < of.vertexCount; v++)
            {
                Vector3 position = mesh.Position(of.firstVertex + v), normal = mesh.Normal(of.firstVertex + v);
                Vector3 posed = Vector3.zero, turned = Vector3.zero;
                for (var k = 0; k < mesh.BonesPerVertex[of.firstVertex + v]; k++, at++)
                {
                    var matrix = matrices[mesh.Weights[at].boneIndex];
                    var origin = matrix.MultiplyPoint3x4(Vector3.zero);
                    posed += matrix.MultiplyPoint3x4(position) * mesh.Weights[at].weight;
                    turned += (matrix.MultiplyPoint3x4(normal) - origin) * mesh.Weights[at].weight;
                }
                positions[v] = posed;
                normals[v] = turned * (1f / turned.magnitude);
            }
        }

        [Test(Description = "skinning on the CPU agrees with Unity's formula: positions and normals of all parts")]
        public static void Skinning()
        {
            var character = Scene.Character(1, 1);
            var mesh = character.GetMesh(1);
            using (var clip = AnthroClip.Builtin("walk", character.Body))
            using (var surface = new AnthroMesh(character.Body, 1))
            {
                var skinners = Enumerable.Range(0, surface.PartCount).Select(part => new AnthroSkinner(surface, part)).ToArray();
                using (var crowd = new AnthroCrowdSkin(skinners, clip.JointCount))
                {
                    for (var part = 0; part < skinners.Length; part++)
                    {
                        crowd.Pose(part, clip, Seconds, AnthroWrap.Loop);
                    }
                    crowd.Run();
                    var pose = new AnthroTransform[clip.JointCount];
                    clip.Sample(Seconds, AnthroWrap.Loop, pose);
                    character.Rig.ApplyPose(pose);
                    for (var part = 0; part < skinners.Length; part++)
                    {
                        var count = skinners[part].VertexCount;
                        Vector3[] positions = new Vector3[count], normals = new Vector3[count];
                        Formula(character, mesh, part, positions, normals);
                        for (var v = 0; v < count; v++)
                        {
                            var at = crowd.FirstVertex(part) + v;
                            var name = surface.Part(part).name + " vertex " + v;
                            Expect.That((positions[v] - crowd.Positions[at]).magnitude < 2e-5, name + ": " + positions[v]);
                            Expect.That((normals[v] - crowd.Normals[at]).magnitude < 1e-3,
                                name + ": normals " + normals[v] + " and " + crowd.Normals[at]);
                        }
                    }
                    Expect.Equal(mesh.vertexCount, crowd.FirstVertex(crowd.Count), "vertices");
                }
                Array.ForEach(skinners, skinner => skinner.Dispose());
            }
            Scene.Destroy(character);
        }

        [Test(Description = "AnthroSkin.Run gives the same as AnthroCrowdSkin: from a Burst job, interleaved in one vertex buffer, and with errors")]
        public static void Burst()
        {
            using (var body = AnthroModel.Default.Generate(Scene.Request()))
            using (var clip = AnthroClip.Builtin("walk", body))
            using (var surface = new AnthroMesh(body, 2))
            using (var skinner = new AnthroSkinner(surface))
            using (var crowd = new AnthroCrowdSkin(new[] { skinner, skinner }, clip.JointCount))
            using (var context = new AnthroContext())
            {
                crowd.Pose(0, clip, 0.1, AnthroWrap.Loop);
                crowd.Pose(1, clip, Seconds, AnthroWrap.Loop);
                crowd.Run();
                var expected = Enumerable.Range(0, crowd.Positions.Length).Select(i => crowd.Positions[i]).ToArray();
                var turned = Enumerable.Range(0, crowd.Normals.Length).Select(i => crowd.Normals[i]).ToArray();
                Clear(crowd.Positions);
                Clear(crowd.Normals);
                var those = crowd.Jobs;
                var jobs = new NativeArray<AnthroSkinJob>(those.Length, Allocator.TempJob);
                var status = new NativeArray<int>(1, Allocator.TempJob);
                for (var i = 0; i < those.Length; i++)
                {
                    jobs[i] = those[i];
                }
                new AnthroSkinBurst { context = context.Pointer, jobs = jobs, status = status }.Schedule().Complete();
                Expect.Equal(0, status[0], "status");
                Expect.That(expected.SequenceEqual(Enumerable.Range(0, expected.Length).Select(i => crowd.Positions[i])), "positions");
                Expect.That(turned.SequenceEqual(Enumerable.Range(0, turned.Length).Select(i => crowd.Normals[i])), "normals");

                // Position and normal interleaved, as in a vertex buffer.
                var rows = new Vector3[2 * skinner.VertexCount];
                fixed (Vector3* first = rows)
                {
                    var job = those[1];
                    job.positions = first;
                    job.normals = first + 1;
                    job.positionBytes = (ulong)rows.Length * 12;
                    job.normalBytes = job.positionBytes - 12;
                    job.positionStride = job.normalStride = 24;
                    Expect.Equal(0, AnthroSkin.Run(context.Pointer, &job, 1), "interleaved");
                    job.joints = null;
                    Expect.Equal((int)AnthroError.Pointer, AnthroSkin.Run(context.Pointer, &job, 1), "no joints");
                    job.structSize = 1;
                    Expect.Equal((int)AnthroError.Size, AnthroSkin.Run(IntPtr.Zero, &job, 1), "no size");
                }
                for (var v = 0; v < skinner.VertexCount; v++)
                {
                    Expect.Equal(expected[crowd.FirstVertex(1) + v], rows[2 * v], "position " + v);
                    Expect.Equal(turned[crowd.FirstVertex(1) + v], rows[2 * v + 1], "normal " + v);
                }
                jobs.Dispose();
                status.Dispose();
            }
        }

        [UnmanagedFunctionPointer(CallingConvention.StdCall)]
        delegate void Event(int id, IntPtr data);

        [DllImport("anthronet")]
        static extern void UnityPluginLoad(IntPtr interfaces);

        [DllImport("anthronet")]
        static extern void UnityPluginUnload();

        [Test(Description = "rendering plugin: Unity loads it, the render thread skins a batch, other events do nothing")]
        public static void RenderThread()
        {
            UnityPluginLoad((IntPtr)4096);
            Expect.Equal((IntPtr)4096, AnthroRenderEvent.Interfaces, "interfaces");
            UnityPluginUnload();
            Expect.Equal(IntPtr.Zero, AnthroRenderEvent.Interfaces, "interfaces after it was unloaded");
            using (var body = AnthroModel.Default.Generate(Scene.Request()))
            using (var clip = AnthroClip.Builtin("walk", body))
            using (var surface = new AnthroMesh(body, 3))
            using (var skinner = new AnthroSkinner(surface))
            using (var crowd = new AnthroCrowdSkin(new[] { skinner }, clip.JointCount))
            using (var context = new AnthroContext())
            {
                crowd.Pose(0, clip, Seconds, AnthroWrap.Loop);
                crowd.Run();
                var expected = Enumerable.Range(0, crowd.Positions.Length).Select(i => crowd.Positions[i]).ToArray();
                Clear(crowd.Positions);
                var call = (Event)Marshal.GetDelegateForFunctionPointer(AnthroRenderEvent.Callback, typeof(Event));
                fixed (AnthroSkinJob* first = crowd.Jobs)
                {
                    var batch = new AnthroSkinBatch { context = context.Pointer, jobs = first, count = 1, status = -1 };
                    var data = (IntPtr)(&batch);
                    call(AnthroRenderEvent.Skin + 1, data);
                    call(AnthroRenderEvent.Skin, IntPtr.Zero);
                    Expect.That(batch.status == -1 && crowd.Positions[0].magnitude == 0, "posed by another event");
                    var thread = new System.Threading.Thread(() => call(AnthroRenderEvent.Skin, data));
                    thread.Start();
                    thread.Join();
                    Expect.Equal(0, batch.status, "status");
                    batch.jobs = null;
                    call(AnthroRenderEvent.Skin, data);
                    Expect.Equal((int)AnthroError.Pointer, batch.status, "status of no jobs");
                }
                Expect.That(expected.SequenceEqual(Enumerable.Range(0, expected.Length).Select(i => crowd.Positions[i])), "positions");
            }
        }

        static void Clear(NativeArray<Vector3> array)
        {
            var first = (Vector3*)NativeArrayUnsafeUtility.GetUnsafePtr(array);
            for (var i = 0; i < array.Length; i++)
            {
                first[i] = Vector3.zero;
            }
        }

        [Test(Description = "structures for Burst have only pointers and numbers")]
        public static void Blittable()
        {
            foreach (var field in typeof(AnthroSkinJob).GetFields())
            {
                var type = field.FieldType;
                Expect.That(type.IsPointer || type.IsEnum || type == typeof(IntPtr) || type == typeof(uint) || type == typeof(ulong),
                    field.Name + " is a " + type);
            }
            Expect.Equal(sizeof(AnthroSkinJob), Marshal.SizeOf(typeof(AnthroSkinJob)), "size");
        }

        [Test(Description = "a crowd that nobody disposes is freed by its finaliser")]
        public static void Finalised()
        {
            using (var body = AnthroModel.Default.Generate(new AnthroRequest()))
            {
                var before = NativeArray<Vector3>.Alive;
                var thread = new System.Threading.Thread(() => Forget(body));
                thread.Start();
                thread.Join();
                for (var i = 0; i < 20 && NativeArray<Vector3>.Alive > before; i++)
                {
                    GC.Collect();
                    GC.WaitForPendingFinalizers();
                }
                Expect.That(NativeArray<Vector3>.Alive <= before, "arrays that are alive: " + NativeArray<Vector3>.Alive);
            }
        }

        static void Forget(AnthroBody body)
        {
            using (var surface = new AnthroMesh(body, 3))
            using (var skinner = new AnthroSkinner(surface))
            {
                for (var i = 0; i < 3; i++)
                {
                    new AnthroCrowdSkin(new[] { skinner }, body.JointCount);
                }
            }
        }
    }
}
