// The tests of the Unity package as a program: its own code with stand-ins for Unity's, and the real library. NUnit's
// console runs the tests in it; alone it does what is around them.
//
//     mono anthronet-unity-tests.exe --report FILE      prints NUnit's results as `ok NAME`, `FAILED NAME: why`, `skipped NAME: why`
//     mono anthronet-unity-tests.exe --layout-source    prints a program in C whose output the tests compare layouts with
//     mono anthronet-unity-tests.exe --signatures       prints what the stand-ins have of Unity, as signatures.txt lists it
//     mono anthronet-unity-tests.exe --missing          calls the library and prints what is thrown
//     mono anthronet-unity-tests.exe --speed COUNT      prints times beside their bars, with COUNT characters; 1 where one is
//                                                       several times over its bar
//
// The tests read two variables of the environment: ANTHRONET_SAME_BYTES, the folder that the tests of `ffi` leave, and
// ANTHRONET_LAYOUT, the output of that program in C.
using System;
using System.Xml;

namespace Anthronet.Tests
{
    static class Program
    {
        static int Main(string[] arguments)
        {
            var wish = arguments.Length > 0 ? arguments[0] : "";
            switch (wish)
            {
                case "--report":
                    return Report(arguments[1]);
                case "--layout-source":
                    Console.Write(LayoutTests.Source());
                    return 0;
                case "--signatures":
                    Console.Write(SignatureTests.Text());
                    return 0;
                case "--missing":
                    return Missing();
                case "--speed":
                    Speed.Print(int.Parse(arguments[1]));
                    return 0;
                default:
                    Console.Error.WriteLine("expected --report, --layout-source, --signatures, --missing or --speed, got " + wish);
                    return 2;
            }
        }

        static int Report(string file)
        {
            var results = new XmlDocument();
            results.Load(file);
            var failed = 0;
            foreach (XmlElement one in results.GetElementsByTagName("test-case"))
            {
                var name = one.GetAttribute("description");
                name = "Unity: " + (name.Length > 0 ? name : one.GetAttribute("name"));
                var messages = one.GetElementsByTagName("message");
                var why = messages.Count == 0 ? "" : ": " + messages[0].InnerText.Trim().Replace("\n", " ");
                var places = one.GetElementsByTagName("stack-trace");
                switch (one.GetAttribute("result"))
                {
                    case "Success":
                        Console.WriteLine("ok " + name);
                        break;
                    case "Ignored":
                    case "Skipped":
                        Console.WriteLine("skipped " + name + why);
                        break;
                    default:
                        failed++;
                        Console.WriteLine("FAILED " + name + why);
                        if (places.Count > 0)
                        {
                            Console.WriteLine(places[0].InnerText.Trim());
                        }
                        break;
                }
            }
            return failed == 0 ? 0 : 1;
        }

        static int Missing()
        {
            try
            {
                AnthroModel.OpenEmbedded();
            }
            catch (DllNotFoundException error)
            {
                Console.WriteLine(error.Message);
                return 0;
            }
            return 1;
        }
    }
}
