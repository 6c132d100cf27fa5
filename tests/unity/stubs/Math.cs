// Stand-ins for Unity's vectors and matrices, as far as package and tests use them. See ../signatures.txt.
using System;
using System.Runtime.InteropServices;

namespace UnityEngine
{
    [StructLayout(LayoutKind.Sequential)]
    public struct Vector3
    {
        public float x, y, z;

        public Vector3(float x, float y, float z)
        {
            this.x = x;
            this.y = y;
            this.z = z;
        }

        public static Vector3 zero { get { return new Vector3(); } }
        public static Vector3 one { get { return new Vector3(1, 1, 1); } }
        public float magnitude { get { return (float)Math.Sqrt(Dot(this, this)); } }

        public static float Dot(Vector3 lhs, Vector3 rhs)
        {
            return lhs.x * rhs.x + lhs.y * rhs.y + lhs.z * rhs.z;
        }

        public static Vector3 Cross(Vector3 lhs, Vector3 rhs)
        {
            Vector3 a = lhs, b = rhs;
            return new Vector3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
        }

        public static Vector3 Min(Vector3 lhs, Vector3 rhs)
        {
            Vector3 a = lhs, b = rhs;
            return new Vector3(Math.Min(a.x, b.x), Math.Min(a.y, b.y), Math.Min(a.z, b.z));
        }

        public static Vector3 Max(Vector3 lhs, Vector3 rhs)
        {
            Vector3 a = lhs, b = rhs;
            return new Vector3(Math.Max(a.x, b.x), Math.Max(a.y, b.y), Math.Max(a.z, b.z));
        }

        public static Vector3 operator +(Vector3 a, Vector3 b) { return new Vector3(a.x + b.x, a.y + b.y, a.z + b.z); }
        public static Vector3 operator -(Vector3 a, Vector3 b) { return new Vector3(a.x - b.x, a.y - b.y, a.z - b.z); }
        public static Vector3 operator *(Vector3 a, float d) { return new Vector3(a.x * d, a.y * d, a.z * d); }
        public override string ToString() { return "(" + x + ", " + y + ", " + z + ")"; }
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Vector2
    {
        public float x, y;

        public Vector2(float x, float y)
        {
            this.x = x;
            this.y = y;
        }
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Vector4
    {
        public float x, y, z, w;

        public Vector4(float x, float y, float z, float w)
        {
            this.x = x;
            this.y = y;
            this.z = z;
            this.w = w;
        }
    }

    public struct Rect
    {
        public Rect(float x, float y, float width, float height) { }
    }

    [StructLayout(LayoutKind.Sequential)]
    public struct Quaternion
    {
        public float x, y, z, w;

        public Quaternion(float x, float y, float z, float w)
        {
            this.x = x;
            this.y = y;
            this.z = z;
            this.w = w;
        }

        public static float Dot(Quaternion a, Quaternion b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }
        public static Quaternion operator *(Quaternion lhs, Quaternion rhs)
        {
            Quaternion a = lhs, b = rhs;
            return new Quaternion(
                a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                a.w * b.y + a.y * b.w + a.z * b.x - a.x * b.z,
                a.w * b.z + a.z * b.w + a.x * b.y - a.y * b.x,
                a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z);
        }

        public static Quaternion identity { get { return new Quaternion(0, 0, 0, 1); } }
    }

    /// Column-major, as in Unity: the fields go down the columns.
    [StructLayout(LayoutKind.Sequential)]
    public struct Matrix4x4
    {
        public float m00, m10, m20, m30, m01, m11, m21, m31, m02, m12, m22, m32, m03, m13, m23, m33;

        public static Matrix4x4 identity { get { return TRS(Vector3.zero, Quaternion.identity, Vector3.one); } }

        public static Matrix4x4 TRS(Vector3 pos, Quaternion q, Vector3 s)
        {
            var p = pos;
            var m = new Matrix4x4();
            m.m00 = s.x * (1 - 2 * (q.y * q.y + q.z * q.z));
            m.m10 = s.x * 2 * (q.x * q.y + q.w * q.z);
            m.m20 = s.x * 2 * (q.x * q.z - q.w * q.y);
            m.m01 = s.y * 2 * (q.x * q.y - q.w * q.z);
            m.m11 = s.y * (1 - 2 * (q.x * q.x + q.z * q.z));
            m.m21 = s.y * 2 * (q.y * q.z + q.w * q.x);
            m.m02 = s.z * 2 * (q.x * q.z + q.w * q.y);
            m.m12 = s.z * 2 * (q.y * q.z - q.w * q.x);
            m.m22 = s.z * (1 - 2 * (q.x * q.x + q.y * q.y));
            m.m03 = p.x;
            m.m13 = p.y;
            m.m23 = p.z;
            m.m33 = 1;
            return m;
        }

        public Vector3 MultiplyPoint3x4(Vector3 point)
        {
            var v = point;
            return new Vector3(
                m00 * v.x + m01 * v.y + m02 * v.z + m03,
                m10 * v.x + m11 * v.y + m12 * v.z + m13,
                m20 * v.x + m21 * v.y + m22 * v.z + m23);
        }

        public static Matrix4x4 operator *(Matrix4x4 lhs, Matrix4x4 rhs)
        {
            Matrix4x4 a = lhs, b = rhs;
            var m = new Matrix4x4();
            for (var row = 0; row < 4; row++)
            {
                for (var column = 0; column < 4; column++)
                {
                    var sum = 0f;
                    for (var k = 0; k < 4; k++)
                    {
                        sum += a[row, k] * b[k, column];
                    }
                    m[row, column] = sum;
                }
            }
            return m;
        }

        public unsafe float this[int row, int column]
        {
            get { fixed (float* first = &m00) { return first[row + 4 * column]; } }
            set { fixed (float* first = &m00) { first[row + 4 * column] = value; } }
        }
    }

    public struct Bounds
    {
        Vector3 middle, half;

        public Bounds(Vector3 center, Vector3 size)
        {
            middle = center;
            half = size * 0.5f;
        }

        public Vector3 center { get { return middle; } }
        public Vector3 size { get { return half * 2; } }
        public Vector3 min { get { return middle - half; } }
        public Vector3 max { get { return middle + half; } }

        public void Encapsulate(Bounds bounds)
        {
            SetMinMax(Vector3.Min(min, bounds.min), Vector3.Max(max, bounds.max));
        }

        public void SetMinMax(Vector3 min, Vector3 max)
        {
            half = (max - min) * 0.5f;
            middle = min + half;
        }
    }

    public struct Color
    {
        public float r, g, b, a;

        public Color(float r, float g, float b, float a)
        {
            this.r = r;
            this.g = g;
            this.b = b;
            this.a = a;
        }

        public Color gamma { get { return new Color(Gamma(r), Gamma(g), Gamma(b), a); } }

        static float Gamma(float v)
        {
            return v <= 0.0031308f ? 12.92f * v : 1.055f * (float)Math.Pow(v, 1 / 2.4) - 0.055f;
        }

        public override string ToString() { return "RGBA(" + r + ", " + g + ", " + b + ", " + a + ")"; }
    }

    public struct Mathf
    {
        public static int Clamp(int value, int min, int max) { return Math.Max(min, Math.Min(max, value)); }
        public static int Min(int a, int b) { return Math.Min(a, b); }
        public static int Max(int a, int b) { return Math.Max(a, b); }
        public static float Max(float a, float b) { return Math.Max(a, b); }
        public static float Clamp01(float value) { return Math.Max(0f, Math.Min(1f, value)); }
    }
}
