using System;
using System.Collections.Generic;
using System.Globalization;
using System.Text;

namespace Anthronet.Native
{
    /// <summary>
    /// Reads top-level values of JSON objects that the library wrote: words, numbers, lists of numbers
    /// and of texts. Not a general JSON parser; Unity has none for such objects.
    /// </summary>
    internal struct AnthroJson
    {
        readonly string json;

        public AnthroJson(string json)
        {
            this.json = json;
        }

        /// <summary>A word or number without quotes; null if the key is missing or its value is null.</summary>
        public string Word(string key)
        {
            var start = Start(key);
            if (start < 0)
            {
                return null;
            }
            var end = json.IndexOfAny(new[] { ',', '}' }, start);
            var word = json.Substring(start, end - start).Trim().Trim('"');
            return word == "null" ? null : word;
        }

        /// <summary>A list of numbers; empty if the key is missing or its value is null.</summary>
        public double[] Numbers(string key)
        {
            var start = Start(key);
            if (start < 0 || json[start] != '[')
            {
                return new double[0];
            }
            var words = json.Substring(start + 1, json.IndexOf(']', start) - start - 1)
                .Split(new[] { ',' }, StringSplitOptions.RemoveEmptyEntries);
            return Array.ConvertAll(words, word => double.Parse(word, CultureInfo.InvariantCulture));
        }

        /// <summary>A list of texts; empty if the key is missing or its value is null.</summary>
        public string[] Texts(string key)
        {
            var texts = new List<string>();
            var at = Start(key);
            if (at < 0 || json[at] != '[')
            {
                return new string[0];
            }
            for (at++; json[at] != ']'; at++)
            {
                if (json[at] == '"')
                {
                    texts.Add(Text(ref at));
                }
            }
            return texts.ToArray();
        }

        /// The text that begins at a quotation mark; `at` moves to the one that ends it.
        string Text(ref int at)
        {
            var text = new StringBuilder();
            for (at++; json[at] != '"'; at++)
            {
                if (json[at] != '\\')
                {
                    text.Append(json[at]);
                    continue;
                }
                at++;
                var escaped = "\"\\/bfnrt".IndexOf(json[at]);
                if (escaped < 0)
                {
                    // `u` and four digits.
                    text.Append((char)Convert.ToInt32(json.Substring(at + 1, 4), 16));
                    at += 4;
                }
                else
                {
                    text.Append("\"\\/\b\f\n\r\t"[escaped]);
                }
            }
            return text.ToString();
        }

        int Start(string key)
        {
            var quoted = "\"" + key + "\":";
            var at = json.IndexOf(quoted, StringComparison.Ordinal);
            if (at < 0)
            {
                return -1;
            }
            at += quoted.Length;
            while (json[at] == ' ' || json[at] == '\n')
            {
                at++;
            }
            return at;
        }
    }
}
