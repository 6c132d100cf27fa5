using System;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using System.Reflection;
using System.Text;
using NUnit.Framework;

namespace Anthronet.Tests
{
    /// Compares the API of the stand-ins with signatures.txt, which has a documentation page for every member.
    [TestFixture]
    public static class SignatureTests
    {
        const string Manual = "https://docs.unity3d.com/2021.3/Documentation/ScriptReference/";
        const string Burst = "https://docs.unity3d.com/Packages/com.unity.burst@1.8/api/";
        /// Unity's own source, for members without a page in the manual.
        const string Source = "https://github.com/Unity-Technologies/UnityCsReference/blob/2021.3/";
        const BindingFlags Own = BindingFlags.Public | BindingFlags.Instance | BindingFlags.Static | BindingFlags.DeclaredOnly;

        static IEnumerable<Type> Types()
        {
            return typeof(UnityEngine.Object).Assembly.GetTypes()
                .Where(type => type.Namespace != null && (type.Namespace.StartsWith("Unity")) && (type.IsPublic || type.IsNestedPublic))
                .OrderBy(type => type.FullName, StringComparer.Ordinal);
        }

        static string Name(Type type)
        {
            if (type.IsByRef)
            {
                return "out " + Name(type.GetElementType());
            }
            if (type.IsArray)
            {
                return Name(type.GetElementType()) + "[]";
            }
            if (type.IsPointer)
            {
                return Name(type.GetElementType()) + "*";
            }
            if (type.IsGenericParameter)
            {
                return type.Name;
            }
            var name = type.IsNested ? Name(type.DeclaringType) + "." + type.Name : type.Name;
            var tick = name.IndexOf('`');
            return tick < 0 ? name : name.Substring(0, tick) + "<" + string.Join(", ", type.GetGenericArguments().Select(Name)) + ">";
        }

        static string Parameters(MethodBase method)
        {
            return "(" + string.Join(", ", method.GetParameters().Select(p =>
                (p.IsDefined(typeof(ParamArrayAttribute)) ? "params " : "") + Name(p.ParameterType) + " " + p.Name)) + ")";
        }

        /// The documentation page of a type: its name without UnityEngine or UnityEditor, with a dot before nested types.
        static string Page(Type type)
        {
            if (type.Namespace == "Unity.Burst")
            {
                return Burst + type.FullName + ".html";
            }
            var name = type.FullName.Replace('+', '.').Replace('`', '_');
            foreach (var root in new[] { "UnityEngine.", "UnityEditor." })
            {
                name = name.StartsWith(root) ? name.Substring(root.Length) : name;
            }
            return Manual + name;
        }

        /// The file of Unity's source for a member without a documentation page; null if it has one.
        static string Undocumented(Type type, string member)
        {
            switch (type.Name)
            {
                case "AnimationClipSettings":
                    return "Editor/Mono/Animation/AnimationClipSettings.bindings.cs";
                case "AnimationUtility":
                    return member.EndsWith("AnimationClipSettings") ? "Editor/Mono/Animation/AnimationUtility.bindings.cs" : null;
                case "Matrix4x4":
                    return member.Length == 3 && member[0] == 'm' ? "Runtime/Export/Math/Matrix4x4.cs" : null;
                case "MovedFromAttribute":
                    return "Runtime/Export/Scripting/APIUpdating/UpdatedFromAttribute.cs";
                case "SkinnedMeshRenderer":
                    return member == "rootBone" ? "Runtime/Export/Graphics/GraphicsRenderers.bindings.cs" : null;
                default:
                    return null;
            }
        }

        /// A line of the list: a type or member, and where it is documented.
        static string Line(string what, Type type, string member, string page)
        {
            var file = Undocumented(type, member);
            return what + " | " + (file == null ? page : Source + file);
        }

        static IEnumerable<string> Members(Type type)
        {
            var page = Page(type);
            var kind = type.IsEnum ? "enum" : type.IsInterface ? "interface" : typeof(Delegate).IsAssignableFrom(type) ? "delegate"
                : type.IsValueType ? "struct" : "class";
            yield return Line(kind + " " + Name(type), type, "", page.EndsWith(".html") ? page : page + ".html");
            if (kind == "delegate" || page.StartsWith(Burst))
            {
                yield break;
            }
            foreach (var field in type.GetFields(Own).Where(field => !field.IsSpecialName))
            {
                var value = type.IsEnum ? " = " + Convert.ToInt64(field.GetRawConstantValue()) : "";
                var still = field.IsStatic && !type.IsEnum ? "static " : "";
                yield return Line("  " + still + Name(field.FieldType) + " " + field.Name + value, type, field.Name,
                    page + (type.IsEnum ? "." : "-") + field.Name + ".html");
            }
            foreach (var made in type.GetConstructors(Own).Where(made => made.GetParameters().Length > 0))
            {
                yield return Line("  " + Name(type) + Parameters(made), type, "", page + "-ctor.html");
            }
            foreach (var property in type.GetProperties(Own))
            {
                var reader = property.GetGetMethod() ?? property.GetSetMethod();
                if (reader.GetBaseDefinition() != reader)
                {
                    continue;
                }
                var access = (property.GetGetMethod() == null ? "" : " get;") + (property.GetSetMethod() == null ? "" : " set;");
                var index = property.GetIndexParameters();
                var place = index.Length > 0 ? ".Index_operator" : "-" + property.Name;
                var name = index.Length > 0 ? "this[" + string.Join(", ", index.Select(p => Name(p.ParameterType) + " " + p.Name)) + "]" : property.Name;
                yield return Line("  " + (reader.IsStatic ? "static " : "") + Name(property.PropertyType) + " " + name + " {" + access + " }",
                    type, property.Name, page + place + ".html");
            }
            foreach (var raised in type.GetEvents(Own))
            {
                yield return "  event " + Name(raised.EventHandlerType) + " " + raised.Name + " | " + page + "-" + raised.Name + ".html";
            }
            foreach (var method in type.GetMethods(Own).Where(method => !method.IsSpecialName || method.Name.StartsWith("op_")))
            {
                if (method.GetBaseDefinition().DeclaringType == typeof(object))
                {
                    continue;
                }
                yield return Line("  " + (method.IsStatic ? "static " : "") + Name(method.ReturnType) + " " + method.Name
                    + Parameters(method), type, method.Name, page + Operator(method.Name) + ".html");
            }
        }

        static string Operator(string name)
        {
            switch (name)
            {
                case "op_Addition": return "-operator_add";
                case "op_Subtraction": return "-operator_subtract";
                case "op_Multiply": return "-operator_multiply";
                case "op_Equality": return "-operator_eq";
                case "op_Inequality": return "-operator_ne";
                default: return "." + name;
            }
        }

        /// The list as it should be.
        internal static string Text()
        {
            var text = new StringBuilder();
            foreach (var line in Types().SelectMany(Members))
            {
                text.Append(line).Append('\n');
            }
            return text.ToString();
        }

        [Test(Description = "the stand-ins have exactly the API in signatures.txt, where each member has its documentation page")]
        public static void Listed()
        {
            var file = Path.Combine(SampleTests.Root, "tests/unity/signatures.txt");
            var listed = new HashSet<string>(File.ReadAllLines(file));
            var there = Text().Split(new[] { '\n' }, StringSplitOptions.RemoveEmptyEntries);
            Expect.That(there.Length > 300, "only " + there.Length + " members");
            Expect.Equal("", string.Join("\n", there.Where(line => !listed.Contains(line))), "not listed");
            Expect.Equal("", string.Join("\n", listed.Except(there)), "listed, but not there");
            Expect.That(there.All(line => line.Contains(" | https://docs.unity3d.com/") || line.Contains(" | " + Source)), "without a page");
        }
    }
}
