// The tests of the Unity package as a program: the package with stand-ins for Unity's API and the real native library.
// NUnit's console runs the tests; run on its own, the program does the following.
//
//     mono anthronet-unity-tests.exe --report FILE      prints NUnit's results as `ok NAME`, `FAILED NAME: why`, `skipped
// NAME: why`     mono anthronet-unity-tests.exe --layout-source    prints a C program whose output is compared with the
// memory layouts     mono anthronet-unity-tests.exe --signatures       prints the API of the stand-ins in the format of
// signatures.txt     mono anthronet-unity-tests.exe --missing          calls the library and prints the exception
//     mono anthronet-unity-tests.exe --speed COUNT      prints times with their targets, for COUNT characters
//
// The tests read environment variables: ANTHRONET_SAME_BYTES, the folder that the tests of `ffi` write; ANTHRONET_LAYOUT,
// the output of the C program; ANTHRONET_CLIPS, a folder of motion files.
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
