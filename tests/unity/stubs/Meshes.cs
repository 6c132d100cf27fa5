// Stand-ins for Unity's meshes and native arrays, as far as package and tests use them, with the checks that Unity
// documents. See ../signatures.txt.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;
using UnityEngine.Rendering;

namespace Unity.Collections
{
    public enum Allocator
    {
        Invalid = 0,
        None = 1,
        Temp = 2,
        TempJob = 3,
        Persistent = 4,
    }

    public enum NativeArrayOptions
    {
        UninitializedMemory = 0,
        ClearMemory = 1,
    }

    public unsafe struct NativeArray<T> : IDisposable where T : struct
    {
        internal IntPtr buffer;
        bool view;

        /// Arrays not disposed yet.
        internal static int Alive;

        public NativeArray(
            int length, Allocator allocator, NativeArrayOptions options = NativeArrayOptions.ClearMemory)
        {
            Length = length;
            view = false;
            var bytes = length * Marshal.SizeOf(typeof(T));
            buffer = Marshal.AllocHGlobal(bytes + 1);
            // What Unity leaves uninitialised is filled with a conspicuous value.
            var fill = options == NativeArrayOptions.ClearMemory ? 0L : unchecked((long)0xEEEEEEEEEEEEEEEE);
            var words = (long*)buffer;
            for (var i = 0; i < bytes / 8; i++)
            {
                words[i] = fill;
            }
            for (var i = bytes / 8 * 8; i < bytes; i++)
            {
                ((byte*)buffer)[i] = (byte)fill;
            }
            Alive++;
        }

        NativeArray(IntPtr buffer, int length)
        {
            this.buffer = buffer;
            Length = length;
            view = true;
        }

        internal static NativeArray<T> Over(IntPtr buffer, int length) { return new NativeArray<T>(buffer, length); }

        public int Length { get; private set; }
        public bool IsCreated { get { return buffer != IntPtr.Zero; } }

        public T this[int index]
        {
            get
            {
                if (index < 0 || index >= Length)
                {
                    throw new IndexOutOfRangeException();
                }
                var size = Marshal.SizeOf(typeof(T));
                return (T)Marshal.PtrToStructure((IntPtr)((byte*)buffer + (long)index * size), typeof(T));
            }
            set
            {
                if (index < 0 || index >= Length)
                {
                    throw new IndexOutOfRangeException();
                }
                Marshal.StructureToPtr(value, (IntPtr)((byte*)buffer + (long)index * Marshal.SizeOf(typeof(T))), false);
            }
        }

        public NativeArray<T> GetSubArray(int start, int length)
        {
            if (start < 0 || length < 0 || start + length > Length)
            {
                throw new ArgumentOutOfRangeException();
            }
            return Over((IntPtr)((byte*)buffer + start * Marshal.SizeOf(typeof(T))), length);
        }

        public void Dispose()
        {
            if (view || buffer == IntPtr.Zero)
            {
                throw new InvalidOperationException("not to be disposed of, or disposed of before");
            }
            Marshal.FreeHGlobal(buffer);
            buffer = IntPtr.Zero;
            Alive--;
        }
    }
}

namespace Unity.Collections.LowLevel.Unsafe
{
    public static class NativeArrayUnsafeUtility
    {
        public static unsafe void* GetUnsafePtr<T>(NativeArray<T> nativeArray) where T : struct
        {
            return (void*)nativeArray.buffer;
        }

        public static unsafe void* GetUnsafeReadOnlyPtr<T>(NativeArray<T> nativeArray) where T : struct
        {
            return (void*)nativeArray.buffer;
        }
    }
}

namespace UnityEngine.Rendering
{
    public enum VertexAttribute
    {
        Position = 0,
        Normal = 1,
        Tangent = 2,
        Color = 3,
        TexCoord0 = 4,
    }

    public enum VertexAttributeFormat
    {
        Float32 = 0,
    }

    public enum IndexFormat
    {
        UInt16 = 0,
        UInt32 = 1,
    }

    [Flags]
    public enum MeshUpdateFlags
    {
        Default = 0,
        DontValidateIndices = 1,
        DontResetBoneBounds = 2,
        DontNotifyMeshUsers = 4,
        DontRecalculateBounds = 8,
    }

    public struct VertexAttributeDescriptor
    {
        public VertexAttributeDescriptor(VertexAttribute attribute = VertexAttribute.Position,
            VertexAttributeFormat format = VertexAttributeFormat.Float32, int dimension = 3, int stream = 0)
        {
            this.attribute = attribute;
            this.format = format;
            this.dimension = dimension;
            this.stream = stream;
        }

        public VertexAttribute attribute { get; set; }
        public VertexAttributeFormat format { get; set; }
        public int dimension { get; set; }
        public int stream { get; set; }
    }

    public struct SubMeshDescriptor
    {
        public SubMeshDescriptor(int indexStart, int indexCount, MeshTopology topology = MeshTopology.Triangles)
            : this()
        {
            this.indexStart = indexStart;
            this.indexCount = indexCount;
            this.topology = topology;
        }

        public Bounds bounds { get; set; }
        public MeshTopology topology { get; set; }
        public int indexStart { get; set; }
        public int indexCount { get; set; }
        public int baseVertex { get; set; }
        public int firstVertex { get; set; }
        public int vertexCount { get; set; }
    }
}

namespace UnityEngine
{
    public enum MeshTopology
    {
        Triangles = 0,
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct BoneWeight1
    {
        float m_Weight;
        int m_BoneIndex;
        public float weight { get { return m_Weight; } set { m_Weight = value; } }
        public int boneIndex { get { return m_BoneIndex; } set { m_BoneIndex = value; } }
    }

    public sealed unsafe class Mesh : Object
    {
        internal float[][] Streams;
        internal uint[] Indices;
        internal IndexFormat Format;
        internal SubMeshDescriptor[] Parts;
        internal byte[] BonesPerVertex;
        internal BoneWeight1[] Weights;
        internal readonly Dictionary<string, Vector3[]> Shapes = new Dictionary<string, Vector3[]>();
        internal readonly List<string> ShapeNames = new List<string>();
        internal readonly Dictionary<string, Vector3[]> ShapeNormals = new Dictionary<string, Vector3[]>();

        public int vertexCount { get { return Streams == null ? 0 : Streams[0].Length / 6; } }
        public Bounds bounds { get; set; }
        public Matrix4x4[] bindposes { get; set; }
        public int subMeshCount { get { return Parts.Length; } }
        public SubMeshDescriptor GetSubMesh(int index) { return Parts[index]; }
        public IndexFormat indexFormat { get { return Format; } }
        public int blendShapeCount { get { return Shapes.Count; } }
        public int GetBlendShapeIndex(string blendShapeName) { return ShapeNames.IndexOf(blendShapeName); }
        public void ClearBlendShapes()
        {
            Shapes.Clear();
            ShapeNormals.Clear();
            ShapeNames.Clear();
        }

        public void SetSubMesh(int index, SubMeshDescriptor desc, MeshUpdateFlags flags = MeshUpdateFlags.Default)
        {
            Parts[index] = desc;
        }

        internal Vector3 Position(int vertex)
        {
            return new Vector3(Streams[0][6 * vertex], Streams[0][6 * vertex + 1], Streams[0][6 * vertex + 2]);
        }

        internal Vector3 Normal(int vertex)
        {
            return new Vector3(Streams[0][6 * vertex + 3], Streams[0][6 * vertex + 4], Streams[0][6 * vertex + 5]);
        }

        public struct MeshData
        {
            internal sealed class Memory
            {
                public int vertices;
                public int[] floats;
                public IntPtr[] streams;
                public int indices;
                public int indexSize;
                public IntPtr index;
                public SubMeshDescriptor[] parts;
            }

            internal Memory memory;

            public void SetVertexBufferParams(int vertexCount, params VertexAttributeDescriptor[] attributes)
            {
                memory.vertices = vertexCount;
                memory.floats = new int[4];
                foreach (var attribute in attributes)
                {
                    memory.floats[attribute.stream] += attribute.dimension;
                }
                memory.streams = new IntPtr[4];
                for (var i = 0; i < 4; i++)
                {
                    memory.streams[i] = Marshal.AllocHGlobal(4 * vertexCount * memory.floats[i] + 4);
                }
            }

            public void SetIndexBufferParams(int indexCount, IndexFormat format)
            {
                memory.indexSize = format == IndexFormat.UInt16 ? 2 : 4;
                memory.indices = indexCount;
                memory.index = Marshal.AllocHGlobal(4 * indexCount + 4);
            }

            public int subMeshCount { set { memory.parts = new SubMeshDescriptor[value]; } }

            public NativeArray<T> GetVertexData<T>(int stream = 0) where T : struct
            {
                return NativeArray<T>.Over(memory.streams[stream], memory.vertices * memory.floats[stream]);
            }

            public NativeArray<T> GetIndexData<T>() where T : struct
            {
                if (Marshal.SizeOf(typeof(T)) != memory.indexSize)
                {
                    throw new InvalidOperationException("GetIndexData: of another size");
                }
                return NativeArray<T>.Over(memory.index, memory.indices);
            }

            public void SetSubMesh(int index, SubMeshDescriptor desc, MeshUpdateFlags flags = MeshUpdateFlags.Default)
            {
                if (memory.parts == null || desc.indexStart + desc.indexCount > memory.indices)
                {
                    throw new ArgumentException("SetSubMesh: beyond the last index");
                }
                memory.parts[index] = desc;
            }
        }

        public struct MeshDataArray : IDisposable
        {
            internal MeshData[] all;
            public MeshData this[int index] { get { return all[index]; } }
            public int Length { get { return all.Length; } }

            public void Dispose()
            {
                foreach (var one in all)
                {
                    if (one.memory.streams != null)
                    {
                        Array.ForEach(one.memory.streams, Marshal.FreeHGlobal);
                        Marshal.FreeHGlobal(one.memory.index);
                    }
                }
                Pending--;
            }
        }

        /// Writable mesh data neither applied nor disposed.
        internal static int Pending;

        public static MeshDataArray AllocateWritableMeshData(int meshCount)
        {
            var array = new MeshDataArray { all = new MeshData[meshCount] };
            for (var i = 0; i < meshCount; i++)
            {
                array.all[i].memory = new MeshData.Memory();
            }
            Pending++;
            return array;
        }

        public static void ApplyAndDisposeWritableMeshData(
            MeshDataArray data, Mesh mesh, MeshUpdateFlags flags = MeshUpdateFlags.Default)
        {
            var from = data.all[0].memory;
            mesh.Streams = new float[2][];
            for (var i = 0; i < 2; i++)
            {
                mesh.Streams[i] = new float[from.vertices * from.floats[i]];
                Marshal.Copy(from.streams[i], mesh.Streams[i], 0, mesh.Streams[i].Length);
            }
            mesh.Indices = new uint[from.indices];
            fixed (uint* to = mesh.Indices)
            {
                if (from.indexSize == 4)
                {
                    Buffer.MemoryCopy((void*)from.index, to, 4L * from.indices, 4L * from.indices);
                }
                for (var i = 0; from.indexSize == 2 && i < from.indices; i++)
                {
                    to[i] = ((ushort*)from.index)[i];
                }
            }
            mesh.Format = from.indexSize == 2 ? IndexFormat.UInt16 : IndexFormat.UInt32;
            mesh.Parts = from.parts;
            data.Dispose();
        }

        public void SetVertexBufferData<T>(NativeArray<T> data, int dataStart, int meshBufferStart, int count, int stream = 0,
            MeshUpdateFlags flags = MeshUpdateFlags.Default) where T : struct
        {
            if (typeof(T) != typeof(float) || dataStart + count > data.Length
                || meshBufferStart + count > Streams[stream].Length)
            {
                throw new ArgumentException("SetVertexBufferData: beyond the end");
            }
            Marshal.Copy((IntPtr)((float*)data.buffer + dataStart), Streams[stream], meshBufferStart, count);
        }

        public void SetBoneWeights(NativeArray<byte> bonesPerVertex, NativeArray<BoneWeight1> weights)
        {
            if (bonesPerVertex.Length != vertexCount)
            {
                throw new ArgumentException("SetBoneWeights: another number of vertices");
            }
            BonesPerVertex = new byte[bonesPerVertex.Length];
            var total = 0;
            for (var i = 0; i < BonesPerVertex.Length; i++)
            {
                BonesPerVertex[i] = ((byte*)bonesPerVertex.buffer)[i];
                total += BonesPerVertex[i];
            }
            if (total != weights.Length)
            {
                throw new ArgumentException("SetBoneWeights: the numbers of bones have another sum");
            }
            Weights = new BoneWeight1[total];
            fixed (BoneWeight1* to = Weights)
            {
                Buffer.MemoryCopy((void*)weights.buffer, to, 8L * total, 8L * total);
            }
        }

        public void AddBlendShapeFrame(string shapeName, float frameWeight, Vector3[] deltaVertices,
            Vector3[] deltaNormals, Vector3[] deltaTangents)
        {
            if (deltaVertices.Length != vertexCount || Shapes.ContainsKey(shapeName))
            {
                throw new ArgumentException("AddBlendShapeFrame: another number of vertices, or the name is taken");
            }
            if (deltaNormals != null && deltaNormals.Length != vertexCount)
            {
                throw new ArgumentException("AddBlendShapeFrame: another number of normals");
            }
            ShapeNames.Add(shapeName);
            Shapes[shapeName] = (Vector3[])deltaVertices.Clone();
            ShapeNormals[shapeName] = deltaNormals == null ? null : (Vector3[])deltaNormals.Clone();
        }
    }
}
