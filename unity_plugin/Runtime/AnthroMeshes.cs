using System;
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;
using UnityEngine;
using UnityEngine.Rendering;

namespace Anthronet
{
    /// <summary>
    /// Converts native meshes to Unity meshes, one sub-mesh per part, by copying straight into mesh memory. Main thread only.
    /// </summary>
    public static unsafe class AnthroMeshes
    {
        const MeshUpdateFlags Unchecked = MeshUpdateFlags.DontRecalculateBounds
            | MeshUpdateFlags.DontValidateIndices | MeshUpdateFlags.DontNotifyMeshUsers;

        // Updating a mesh to another body rewrites stream 0 only.
        static readonly VertexAttributeDescriptor[] layout =
        {
            new VertexAttributeDescriptor(VertexAttribute.Position, VertexAttributeFormat.Float32, 3, 0),
            new VertexAttributeDescriptor(VertexAttribute.Normal, VertexAttributeFormat.Float32, 3, 0),
            new VertexAttributeDescriptor(VertexAttribute.TexCoord0, VertexAttributeFormat.Float32, 2, 1),
        };

        // Unity takes blend shapes only as managed arrays of the mesh's length: one pair per vertex count serves all.
        static readonly System.Collections.Generic.Dictionary<int, Vector3[][]> pool =
            new System.Collections.Generic.Dictionary<int, Vector3[][]>();

        /// <summary>Makes a Unity mesh with bone weights and bind poses.</summary>
        /// <param name="source">The native mesh; may be disposed afterwards.</param>
        /// <param name="joints">The joints of its body, which have the bind poses.</param>
        /// <param name="name">Name of the mesh.</param>
        public static Mesh Create(AnthroMesh source, AnthroJoint[] joints, string name)
        {
            Native.Library.NotNull(joints, "joints");
            using (var packed = new AnthroPacked(Native.Library.NotNull(source, "source"), true))
            {
                var mesh = Create(packed, joints, name);
                AddBlendShapes(mesh, source);
                return mesh;
            }
        }

        internal static Mesh Create(AnthroPacked packed, AnthroJoint[] joints, string name)
        {
            var mesh = Fill(packed, name);
            Bind(mesh, packed, joints);
            return mesh;
        }

        /// <summary>Makes a mesh of vertices and triangles without bone weights: the first half of `Create`.</summary>
        internal static Mesh Fill(AnthroPacked packed, string name)
        {
            var mesh = new Mesh();
            mesh.name = name;
            Fill(mesh, packed);
            return mesh;
        }

        /// <summary>Adds bone weights and bind poses to a mesh: the second half of `Create`.</summary>
        internal static void Bind(Mesh mesh, AnthroPacked packed, AnthroJoint[] joints)
        {
            FillWeights(mesh, packed);
            SetBindPoses(mesh, joints);
        }

        /// <summary>
        /// Updates a mesh that `Create` made to another body's shape at the same level of detail. Triangles, texture
        /// coordinates and bone weights are the same for every body and are kept; blend shapes are removed.
        /// </summary>
        public static void Update(Mesh mesh, AnthroMesh source, AnthroJoint[] joints)
        {
            Native.Library.NotNull(mesh, "mesh");
            Native.Library.NotNull(joints, "joints");
            using (var packed = new AnthroPacked(Native.Library.NotNull(source, "source"), false))
            {
                Update(mesh, packed, joints);
                AddBlendShapes(mesh, source);
            }
        }

        internal static void Update(Mesh mesh, AnthroPacked packed, AnthroJoint[] joints)
        {
            if (mesh.vertexCount != packed.VertexCount)
            {
                throw new ArgumentException("the mesh has " + mesh.vertexCount + " vertices, the native one "
                    + packed.VertexCount + ": of another level of detail");
            }
            var count = AnthroPacked.FloatsPerVertex * packed.VertexCount;
            var rows = new NativeArray<float>(count, Allocator.Temp, NativeArrayOptions.UninitializedMemory);
            try
            {
                Copy(packed.Vertices, NativeArrayUnsafeUtility.GetUnsafePtr(rows), (long)count * sizeof(float));
                mesh.SetVertexBufferData(rows, 0, 0, count, 0, Unchecked);
            }
            finally
            {
                rows.Dispose();
            }
            for (var part = 0; part < packed.Parts.Length; part++)
            {
                var descriptor = mesh.GetSubMesh(part);
                descriptor.bounds = packed.Bounds[part];
                mesh.SetSubMesh(part, descriptor, Unchecked);
            }
            mesh.bounds = packed.TotalBounds;
            SetBindPoses(mesh, joints);
            mesh.ClearBlendShapes();
        }

        /// <summary>Adds the blend shapes of a native mesh to its Unity mesh, with full weight at 100.</summary>
        public static void AddBlendShapes(Mesh mesh, AnthroMesh source)
        {
            var shapes = source.BlendShapeCount;
            if (shapes == 0)
            {
                return;
            }
            Vector3[][] pair;
            if (!pool.TryGetValue(source.VertexCount, out pair))
            {
                pair = new[] { new Vector3[source.VertexCount], new Vector3[source.VertexCount] };
                pool[source.VertexCount] = pair;
            }
            for (var shape = 0; shape < shapes; shape++)
            {
                fixed (Vector3* positions = pair[0])
                fixed (Vector3* normals = pair[1])
                {
                    var first = 0;
                    for (var part = 0; part < source.PartCount; part++)
                    {
                        var count = source.Part(part).vertexCount;
                        var bytes = (long)count * sizeof(Vector3);
                        source.ReadBlendShape(
                            shape, part, AnthroAttribute.Positions, positions + first, bytes, sizeof(Vector3));
                        source.ReadBlendShape(
                            shape, part, AnthroAttribute.Normals, normals + first, bytes, sizeof(Vector3));
                        first += count;
                    }
                }
                mesh.AddBlendShapeFrame(source.BlendShapeName(shape), 100f, pair[0], pair[1], null);
            }
        }

        static void Fill(Mesh mesh, AnthroPacked packed)
        {
            var meshes = Mesh.AllocateWritableMeshData(1);
            var filled = false;
            try
            {
                var data = meshes[0];
                data.SetVertexBufferParams(packed.VertexCount, layout);
                data.SetIndexBufferParams(packed.IndexCount, packed.Use32BitIndices ? IndexFormat.UInt32 : IndexFormat.UInt16);
                Copy(packed.Vertices, NativeArrayUnsafeUtility.GetUnsafePtr(data.GetVertexData<float>(0)),
                    (long)packed.VertexCount * AnthroPacked.Stride);
                Copy(packed.Uvs, NativeArrayUnsafeUtility.GetUnsafePtr(data.GetVertexData<float>(1)),
                    (long)packed.VertexCount * AnthroPacked.UvStride);
                var indices = packed.Use32BitIndices
                    ? NativeArrayUnsafeUtility.GetUnsafePtr(data.GetIndexData<uint>())
                    : NativeArrayUnsafeUtility.GetUnsafePtr(data.GetIndexData<ushort>());
                Copy(packed.Indices, indices, packed.IndexCount * (packed.Use32BitIndices ? 4L : 2L));
                data.subMeshCount = packed.Parts.Length;
                int vertex = 0, index = 0;
                for (var part = 0; part < packed.Parts.Length; part++)
                {
                    var of = packed.Parts[part];
                    var descriptor = new SubMeshDescriptor(index, 3 * of.triangleCount);
                    // Indices are relative to the part's first vertex.
                    descriptor.baseVertex = vertex;
                    descriptor.firstVertex = vertex;
                    descriptor.vertexCount = of.vertexCount;
                    descriptor.bounds = packed.Bounds[part];
                    data.SetSubMesh(part, descriptor, Unchecked);
                    vertex += of.vertexCount;
                    index += 3 * of.triangleCount;
                }
                filled = true;
                Mesh.ApplyAndDisposeWritableMeshData(meshes, mesh, Unchecked);
                mesh.bounds = packed.TotalBounds;
            }
            finally
            {
                if (!filled)
                {
                    meshes.Dispose();
                }
            }
        }

        static void FillWeights(Mesh mesh, AnthroPacked packed)
        {
            var numbers = new NativeArray<byte>(packed.VertexCount, Allocator.Temp, NativeArrayOptions.UninitializedMemory);
            var rows = new NativeArray<BoneWeight1>(
                packed.WeightCount, Allocator.Temp, NativeArrayOptions.UninitializedMemory);
            try
            {
                Copy(packed.BonesPerVertex, NativeArrayUnsafeUtility.GetUnsafePtr(numbers), packed.VertexCount);
                Copy(packed.Weights, NativeArrayUnsafeUtility.GetUnsafePtr(rows),
                    (long)packed.WeightCount * sizeof(BoneWeight1));
                mesh.SetBoneWeights(numbers, rows);
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

        static void Copy(void* from, void* to, long bytes)
        {
            Buffer.MemoryCopy(from, to, bytes, bytes);
        }
    }
}
