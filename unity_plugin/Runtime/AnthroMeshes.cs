using System;
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;
using UnityEngine;
using UnityEngine.Rendering;

namespace Anthronet
{
    /// <summary>
    /// Surfaces as Unity's meshes. The library writes straight into the mesh's memory; every part is a sub-mesh. On the
    /// main thread alone.
    /// </summary>
    public static unsafe class AnthroMeshes
    {
        const MeshUpdateFlags Unchecked = MeshUpdateFlags.DontRecalculateBounds
            | MeshUpdateFlags.DontValidateIndices | MeshUpdateFlags.DontNotifyMeshUsers;

        // Stream 0 is what an update changes.
        static readonly VertexAttributeDescriptor[] layout =
        {
            new VertexAttributeDescriptor(VertexAttribute.Position, VertexAttributeFormat.Float32, 3, 0),
            new VertexAttributeDescriptor(VertexAttribute.Normal, VertexAttributeFormat.Float32, 3, 0),
            new VertexAttributeDescriptor(VertexAttribute.TexCoord0, VertexAttributeFormat.Float32, 2, 1),
        };

        // Unity takes blend shapes from managed arrays alone: one pair serves all.
        static Vector3[] moved = new Vector3[0];
        static Vector3[] turned = new Vector3[0];

        /// <summary>A mesh of a surface with bone weights and bind poses.</summary>
        /// <param name="surface">The surface; not needed afterwards.</param>
        /// <param name="joints">Of its body: the bind poses.</param>
        /// <param name="name">What the mesh is called.</param>
        public static Mesh Create(AnthroSurface surface, AnthroJoint[] joints, string name)
        {
            var mesh = new Mesh();
            mesh.name = name;
            FillSurface(mesh, surface);
            FillWeights(mesh, surface);
            SetBindPoses(mesh, joints);
            AddBlendShapes(mesh, surface);
            return mesh;
        }

        /// <summary>
        /// Gives a mesh that `Create` made the surface of another body, at the same level of detail. Triangles, texture
        /// coordinates and weights are the same for everybody and stay; blend shapes go.
        /// </summary>
        public static void Update(Mesh mesh, AnthroSurface surface, AnthroJoint[] joints)
        {
            var count = surface.VertexCount;
            if (mesh.vertexCount != count)
            {
                throw new ArgumentException(
                    "the mesh has " + mesh.vertexCount + " vertices, the surface " + count + ": of another level of detail");
            }
            var rows = new NativeArray<Vector3>(count, Allocator.Temp, NativeArrayOptions.UninitializedMemory);
            try
            {
                ReadParts(surface, AnthroAttribute.Positions, rows);
                mesh.SetVertices(rows);
                mesh.bounds = Around((Vector3*)NativeArrayUnsafeUtility.GetUnsafePtr(rows), 1, count);
                ReadParts(surface, AnthroAttribute.Normals, rows);
                mesh.SetNormals(rows);
            }
            finally
            {
                rows.Dispose();
            }
            SetBindPoses(mesh, joints);
            mesh.ClearBlendShapes();
            AddBlendShapes(mesh, surface);
        }

        /// <summary>Adds the blend shapes of a surface to a mesh of it, with full weight at 100.</summary>
        public static void AddBlendShapes(Mesh mesh, AnthroSurface surface)
        {
            var shapes = surface.BlendShapeCount;
            if (shapes > 0 && moved.Length != surface.VertexCount)
            {
                moved = new Vector3[surface.VertexCount];
                turned = new Vector3[surface.VertexCount];
            }
            for (var shape = 0; shape < shapes; shape++)
            {
                fixed (Vector3* positions = moved)
                fixed (Vector3* normals = turned)
                {
                    var first = 0;
                    for (var part = 0; part < surface.PartCount; part++)
                    {
                        var count = surface.Part(part).vertexCount;
                        var bytes = (long)count * sizeof(Vector3);
                        surface.ReadBlendShape(
                            shape, part, AnthroAttribute.Positions, positions + first, bytes, sizeof(Vector3));
                        surface.ReadBlendShape(
                            shape, part, AnthroAttribute.Normals, normals + first, bytes, sizeof(Vector3));
                        first += count;
                    }
                }
                mesh.AddBlendShapeFrame(surface.BlendShapeName(shape), 100f, moved, turned, null);
            }
        }

        static void FillSurface(Mesh mesh, AnthroSurface surface)
        {
            var meshes = Mesh.AllocateWritableMeshData(1);
            var filled = false;
            try
            {
                var data = meshes[0];
                data.SetVertexBufferParams(surface.VertexCount, layout);
                data.SetIndexBufferParams(3 * surface.TriangleCount, IndexFormat.UInt32);
                data.subMeshCount = surface.PartCount;
                const int Floats = 6;
                const int Stride = Floats * sizeof(float);
                var vertices = (float*)NativeArrayUnsafeUtility.GetUnsafePtr(data.GetVertexData<float>(0));
                var uvs = (float*)NativeArrayUnsafeUtility.GetUnsafePtr(data.GetVertexData<float>(1));
                var indices = (uint*)NativeArrayUnsafeUtility.GetUnsafePtr(data.GetIndexData<uint>());
                int vertex = 0, index = 0;
                var bounds = new Bounds();
                for (var part = 0; part < surface.PartCount; part++)
                {
                    var of = surface.Part(part);
                    var first = vertices + Floats * vertex;
                    var bytes = (long)of.vertexCount * Stride;
                    surface.Read(part, AnthroAttribute.Positions, first, bytes, Stride);
                    surface.Read(part, AnthroAttribute.Normals, first + 3, bytes - Stride / 2, Stride);
                    surface.Read(part, AnthroAttribute.Uvs, uvs + 2 * vertex, of.vertexCount * 2L * sizeof(float), 0);
                    surface.Read(part, AnthroAttribute.Triangles, indices + index, of.triangleCount * 3L * sizeof(uint), 0);
                    var descriptor = new SubMeshDescriptor(index, 3 * of.triangleCount);
                    // Triangles count from their part's first vertex.
                    descriptor.baseVertex = vertex;
                    descriptor.firstVertex = vertex;
                    descriptor.vertexCount = of.vertexCount;
                    descriptor.bounds = Around((Vector3*)first, 2, of.vertexCount);
                    data.SetSubMesh(part, descriptor, Unchecked);
                    if (part == 0)
                    {
                        bounds = descriptor.bounds;
                    }
                    bounds.Encapsulate(descriptor.bounds);
                    vertex += of.vertexCount;
                    index += 3 * of.triangleCount;
                }
                filled = true;
                Mesh.ApplyAndDisposeWritableMeshData(meshes, mesh, Unchecked);
                mesh.bounds = bounds;
            }
            finally
            {
                if (!filled)
                {
                    meshes.Dispose();
                }
            }
        }

        static void FillWeights(Mesh mesh, AnthroSurface surface)
        {
            const int Each = AnthroSurface.Influences;
            var count = surface.VertexCount;
            var numbers = new NativeArray<byte>(count, Allocator.Temp, NativeArrayOptions.UninitializedMemory);
            var rows = new NativeArray<BoneWeight1>(Each * count, Allocator.Temp, NativeArrayOptions.UninitializedMemory);
            try
            {
                var number = (byte*)NativeArrayUnsafeUtility.GetUnsafePtr(numbers);
                var row = (BoneWeight1*)NativeArrayUnsafeUtility.GetUnsafePtr(rows);
                var used = 0;
                var influence = new BoneWeight1();
                for (var part = 0; part < surface.PartCount; part++)
                {
                    var joints = (ushort*)surface.View(part, AnthroAttribute.Joints);
                    var weights = (float*)surface.View(part, AnthroAttribute.Weights);
                    for (var end = joints + Each * surface.Part(part).vertexCount; joints < end; joints += Each, weights += Each)
                    {
                        // They come sorted: behind the first zero there is nothing, and the first is none.
                        byte there = 0;
                        while (there < Each && weights[there] > 0f)
                        {
                            influence.boneIndex = joints[there];
                            influence.weight = weights[there];
                            row[used++] = influence;
                            there++;
                        }
                        *number++ = there;
                    }
                }
                mesh.SetBoneWeights(numbers, rows.GetSubArray(0, used));
            }
            finally
            {
                numbers.Dispose();
                rows.Dispose();
            }
        }

        static void SetBindPoses(Mesh mesh, AnthroJoint[] joints)
        {
            var poses = new Matrix4x4[joints.Length];
            for (var i = 0; i < poses.Length; i++)
            {
                poses[i] = joints[i].jointFromModel;
            }
            mesh.bindposes = poses;
        }

        static void ReadParts(AnthroSurface surface, AnthroAttribute attribute, NativeArray<Vector3> into)
        {
            var row = (Vector3*)NativeArrayUnsafeUtility.GetUnsafePtr(into);
            for (var part = 0; part < surface.PartCount; part++)
            {
                var count = surface.Part(part).vertexCount;
                surface.Read(part, attribute, row, (long)count * sizeof(Vector3), 0);
                row += count;
            }
        }

        /// <summary>The box around positions, every `step`-th of the vectors.</summary>
        static Bounds Around(Vector3* position, int step, int count)
        {
            var bounds = new Bounds();
            if (count > 0)
            {
                Vector3 min = *position, max = *position;
                for (var last = position + step * count; position < last; position += step)
                {
                    // By hand: mono calls Vector3.Min for every vertex.
                    if (position->x < min.x) min.x = position->x;
                    else if (position->x > max.x) max.x = position->x;
                    if (position->y < min.y) min.y = position->y;
                    else if (position->y > max.y) max.y = position->y;
                    if (position->z < min.z) min.z = position->z;
                    else if (position->z > max.z) max.z = position->z;
                }
                bounds.SetMinMax(min, max);
            }
            return bounds;
        }
    }
}
