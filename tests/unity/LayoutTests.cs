using System;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using System.Reflection;
using System.Runtime.InteropServices;
using System.Text;
using Anthronet.Native;
using NUnit.Framework;

namespace Anthronet.Tests
{
    /// Memory layout of structures compared with a C compiler's, and the functions of the header.
    [TestFixture]
    public static class LayoutTests
    {
        static IEnumerable<Type> Structures()
        {
            return typeof(NativeMethods).Assembly.GetTypes().Where(type => type.Namespace == "Anthronet.Native"
                && type.Name.StartsWith("anthronet_") && type.IsValueType && Fields(type).Length > 0);
        }

        static FieldInfo[] Fields(Type type)
        {
            return type.GetFields(BindingFlags.Instance | BindingFlags.Public | BindingFlags.NonPublic);
        }

        /// A C program that prints the same as `Lines`.
        internal static string Source()
        {
            var source = new StringBuilder("#include <stddef.h>\n#include <stdio.h>\n#include \"anthronet.h\"\nint main(void) {\n");
            foreach (var type in Structures())
            {
                source.AppendFormat("  printf(\"{0} %zu\\n\", sizeof({0}));\n", type.Name);
                foreach (var field in Fields(type))
                {
                    source.AppendFormat("  printf(\"{0}.{1} %zu\\n\", offsetof({0}, {1}));\n", type.Name, field.Name);
                }
            }
            return source.Append("  return 0;\n}\n").ToString();
        }

        static IEnumerable<string> Lines()
        {
            foreach (var type in Structures())
            {
                yield return type.Name + " " + Marshal.SizeOf(type);
                foreach (var field in Fields(type))
                {
                    yield return type.Name + "." + field.Name + " " + Marshal.OffsetOf(type, field.Name);
                }
            }
        }

        [Test(Description = "structures have the memory layout that C gives them"), Category("NeedsC")]
        public static void LaidOut()
        {
            var file = Environment.GetEnvironmentVariable("ANTHRONET_LAYOUT");
            Expect.That(!string.IsNullOrEmpty(file), "ANTHRONET_LAYOUT is not set: `cargo xtask test --only unity` sets it");
            var expected = File.ReadAllLines(file);
            var found = Lines().ToArray();
            Expect.That(expected.Length > 90, "only " + expected.Length + " lines");
            for (var i = 0; i < Math.Max(expected.Length, found.Length); i++)
            {
                Expect.Equal(expected.ElementAtOrDefault(i), found.ElementAtOrDefault(i), "line " + (i + 1));
            }
        }

        static void Same(Type ours, Type generated, params string[] names)
        {
            Expect.Equal(Marshal.SizeOf(generated), Marshal.SizeOf(ours), "size of " + ours.Name);
            var fields = Fields(generated).Where(field => field.Name != "filler").ToArray();
            for (var i = 0; i < names.Length; i++)
            {
                Expect.Equal(Marshal.OffsetOf(generated, fields[i].Name), Marshal.OffsetOf(ours, names[i]),
                    ours.Name + "." + names[i]);
            }
        }

        [Test(Description = "public structures have the memory layout of the native ones")]
        public static void Public()
        {
            Same(typeof(AnthroTransform), typeof(anthronet_transform), "rotation", "translation");
            Same(typeof(AnthroJoint), typeof(anthronet_joint), "parent", "length", "parentFromJoint", "modelFromJoint",
                "jointFromModel");
            Same(typeof(AnthroMeasureReport), typeof(anthronet_measure_report), "asked", "obtained", "residual", "low90",
                "high90", "percentile", "given", "filled");
            Same(typeof(AnthroSkinJob), typeof(anthronet_skin_job), "structSize", "method", "skinner", "joints", "jointCount",
                "offsetCount", "offsets", "positions", "positionBytes", "positionStride", "normals", "normalBytes",
                "normalStride");
        }

        [Test(Description = "every declared function is in the library")]
        public static void Linked()
        {
            var functions = typeof(NativeMethods)
                .GetMethods(BindingFlags.Static | BindingFlags.NonPublic)
                .Where(method => method.GetCustomAttribute<DllImportAttribute>() != null).ToArray();
            Expect.That(functions.Length >= 80, "only " + functions.Length + " functions");
            Array.ForEach(functions, Marshal.Prelink);
        }

        [Test(Description = "AnthroError has all error codes of the header")]
        public static void Errors()
        {
            var codes = typeof(NativeMethods).GetFields(BindingFlags.Static | BindingFlags.NonPublic)
                .Where(field => field.Name.StartsWith("ANTHRONET_ERROR_")).Select(field => (int)field.GetValue(null));
            var ours = Enum.GetValues(typeof(AnthroError)).Cast<int>();
            Expect.Equal(string.Join(" ", codes.OrderBy(x => x)), string.Join(" ", ours.OrderBy(x => x)), "codes");
        }
    }
}
