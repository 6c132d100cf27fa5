// The tests of the Unity package: its own code with stand-ins for Unity's, and the real library.
//
//     mono anthronet-unity-tests.exe [--same-bytes FOLDER] [--layout FILE] [--layout-source] [--speed AVATARS]
//
// Prints `ok NAME`, `FAILED NAME: why` or `skipped NAME: why` for every case. `--layout-source` prints a program in C
// whose output is what `--layout` compares with; `--speed` prints times beside their bars instead.
using System;
using System.Collections.Generic;
using System.Linq;
using System.Reflection;

namespace Anthronet.Tests
{
    /// A case; its name in words.
    [AttributeUsage(AttributeTargets.Method)]
    sealed class CaseAttribute : Attribute
    {
        public readonly string Name;
        public CaseAttribute(string name) { Name = name; }
    }

    sealed class SkippedException : Exception
    {
        public SkippedException(string why) : base(why) { }
    }

    static class Expect
    {
        public static void That(bool holds, string otherwise)
        {
            if (!holds)
            {
                throw new Exception(otherwise);
            }
        }

        public static void Equal<T>(T expected, T found, string what)
        {
            That(EqualityComparer<T>.Default.Equals(expected, found), what + ": expected " + expected + ", got " + found);
        }

        public static void Near(double expected, double found, double tolerance, string what)
        {
            That(Math.Abs(expected - found) <= tolerance, what + ": expected " + expected + ", got " + found);
        }

        public static T Throws<T>(Action action, string what) where T : Exception
        {
            try
            {
                action();
            }
            catch (T error)
            {
                return error;
            }
            throw new Exception(what + ": expected a " + typeof(T).Name);
        }

        public static void Code(AnthroError code, string word, Action action, string what)
        {
            var error = Throws<AnthroException>(action, what);
            Equal(code, error.Code, what);
            That(error.Message.Contains(word), what + ": the message says no \"" + word + "\": " + error.Message);
        }
    }

    static class Runner
    {
        public static string SameBytes, Layout;

        static int Main(string[] arguments)
        {
            if (arguments.Contains("--layout-source"))
            {
                Console.Write(LayoutTests.Source());
                return 0;
            }
            var speed = Array.IndexOf(arguments, "--speed");
            if (speed >= 0)
            {
                Speed.Print(int.Parse(arguments[speed + 1]));
                return 0;
            }
            for (var i = 0; i + 1 < arguments.Length; i++)
            {
                SameBytes = arguments[i] == "--same-bytes" ? arguments[i + 1] : SameBytes;
                Layout = arguments[i] == "--layout" ? arguments[i + 1] : Layout;
            }
            var cases = from type in Assembly.GetExecutingAssembly().GetTypes()
                        from method in type.GetMethods(BindingFlags.Static | BindingFlags.NonPublic | BindingFlags.Public)
                        let named = (CaseAttribute)Attribute.GetCustomAttribute(method, typeof(CaseAttribute))
                        where named != null
                        select new { named.Name, Run = (Action)Delegate.CreateDelegate(typeof(Action), method) };
            var failed = 0;
            foreach (var one in cases)
            {
                try
                {
                    one.Run();
                    Console.WriteLine("ok Unity: " + one.Name);
                }
                catch (SkippedException why)
                {
                    Console.WriteLine("skipped Unity: " + one.Name + ": " + why.Message);
                }
                catch (Exception error)
                {
                    failed++;
                    Console.WriteLine("FAILED Unity: " + one.Name + ": " + error.ToString().Replace("\n", " "));
                }
            }
            return failed == 0 ? 0 : 1;
        }
    }
}
