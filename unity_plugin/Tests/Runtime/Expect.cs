using System;
using NUnit.Framework;

namespace Anthronet.Tests
{
    /// Assertions with a message.
    public static class Expect
    {
        public static void That(bool holds, string otherwise)
        {
            if (!holds)
            {
                Assert.Fail(otherwise);
            }
        }

        public static void Equal<T>(T expected, T found, string what)
        {
            if (!Equals(expected, found))
            {
                Assert.Fail(what + ": expected " + expected + ", got " + found);
            }
        }

        public static void Near(double expected, double found, double tolerance, string what)
        {
            That(Math.Abs(expected - found) <= tolerance, what + ": expected " + expected + ", got " + found);
        }

        public static T Throws<T>(Action action, string what) where T : Exception
        {
            return Assert.Throws<T>(() => action(), what);
        }

        public static void Code(AnthroError code, string word, Action action, string what)
        {
            var error = Throws<AnthroException>(action, what);
            Equal(code, error.Code, what);
            That(error.Message.Contains(word), what + ": the message says no \"" + word + "\": " + error.Message);
        }
    }
}
