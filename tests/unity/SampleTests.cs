using System;
using System.Collections.Generic;
using System.IO;
using System.Linq;
using System.Runtime.CompilerServices;
using NUnit.Framework;
using UnityEngine;
using Anthronet.Samples;

namespace Anthronet.Tests
{
    /// The samples.
    [TestFixture]
    public static class SampleTests
    {
        [Test(Description = "single character: it follows its sliders and walks on")]
        public static void Single()
        {
            var single = new GameObject("single").AddComponent<SingleCharacter>();
            MonoBehaviour.Send(single, "Start");
            single.height = 1.9f;
            MonoBehaviour.Send(single, "Update");
            var person = single.transform.GetChild(0).gameObject.GetComponent<AnthroCharacter>();
            Expect.Near(1.9, person.Body.Measures()[3].obtained, 1e-3, "height");
            MonoBehaviour.Send(person.GetComponent<AnthroAnimator>(), "LateUpdate");
            UnityEngine.Object.Destroy(single.gameObject);
        }

        static string Population
        {
            get { return File.ReadAllText(Path.Combine(Root, "unity_plugin/Samples~/Crowd/population.jsonl.txt")); }
        }

        /// The repository, from the path that this file was compiled from: Cargo's target folder may be elsewhere.
        internal static string Root
        {
            get { return Path.GetFullPath(Path.Combine(Path.GetDirectoryName(SourceFile()), "../..")); }
        }

        static string SourceFile([CallerFilePath] string path = "")
        {
            return path;
        }

        [Test(Description = "crowd: the population file has 200 different requests, and the model accepts all of them")]
        public static void PopulationFile()
        {
            var requests = Crowd.Requests(Population, 1000);
            Expect.Equal(200, requests.Length, "requests");
            Expect.Equal(200, requests.Select(request => request.ToJson()).Distinct().Count(), "different ones");
            Expect.Equal(7, Crowd.Requests(Population, 7).Length, "as many as asked for");
            Expect.That(requests.All(request => request.IsGiven(3) && request.Fill == AnthroFill.Sample), "statures");
            Expect.Equal(100, requests.Count(request => request.Sex == AnthroSex.Female), "women");
            using (var job = AnthroModel.Default.StartJob(requests))
            {
                int done;
                while (job.Poll(out done) == AnthroJobState.Running)
                {
                    System.Threading.Thread.Sleep(1);
                }
                for (var i = 0; i < requests.Length; i++)
                {
                    using (var body = job.Take(i))
                    {
                        Expect.Near(requests[i][3], body.Measures()[3].obtained, 1e-3, "height of " + i);
                    }
                }
            }
        }

        [Test(Description = "crowd: people stand apart, each with one animator, all walking at different times")]
        public static void CrowdRuns()
        {
            var crowd = new GameObject("crowd").AddComponent<Crowd>();
            crowd.population = new TextAsset(Population);
            crowd.count = 12;
            MonoBehaviour.Send(crowd, "Start");
            for (var frame = 0; AnthroRunner.Count > 0; frame++)
            {
                Expect.That(frame < 30000, "never done");
                System.Threading.Thread.Sleep(1);
                MonoBehaviour.Send((AnthroRunner)Scene.Static(typeof(AnthroRunner), "runner"), "Update");
            }
            var people = Enumerable.Range(0, crowd.transform.childCount).Select(i => crowd.transform.GetChild(i).gameObject).ToArray();
            Expect.Equal(12, people.Length, "people");
            Expect.Equal(12, people.Select(one => one.transform.localPosition).Distinct().Count(), "places");
            Expect.Equal(12, people.Select(one => one.GetComponent<AnthroAnimator>().Time).Distinct().Count(), "times");
            Expect.That(people.All(one => one.activeSelf && one.GetComponent<AnthroAnimator>().Clip.Name == "walk"), "walking");
            var requests = Crowd.Requests(Population, 12);
            for (var i = 0; i < 12; i++)
            {
                Expect.Near(requests[i][3], people[i].GetComponent<AnthroCharacter>().Body.Measures()[3].obtained, 1e-3, "height");
            }
            UnityEngine.Object.Destroy(crowd.gameObject);
            AnthroRunner.Budget = 4.0;
            // Without a file, and for any number of people.
            Expect.Equal(5, Crowd.Requests(null, 5).Select(request => request.Seed).Distinct().Count(), "seeds");
            foreach (var count in new[] { 1, 2, 9, 10, 200 })
            {
                var places = Enumerable.Range(0, count).Select(i => Crowd.Position(i, count, 1.2f)).ToArray();
                var nearest = double.MaxValue;
                for (var i = 0; i < count; i++)
                {
                    for (var k = 0; k < i; k++)
                    {
                        nearest = Math.Min(nearest, (places[i] - places[k]).magnitude);
                    }
                }
                Expect.That(count == 1 || Math.Abs(nearest - 1.2) < 1e-4, count + " people are as near as " + nearest);
            }
        }

        [Test(Description = "measure editor: slider and toggle change the character, errors are shown")]
        public static void Editor()
        {
            var editor = new GameObject("editor").AddComponent<MeasureEditor>();
            MonoBehaviour.Send(editor, "Start");
            var person = editor.transform.GetChild(0).gameObject.GetComponent<AnthroCharacter>();
            try
            {
                var before = person.Body;
                MonoBehaviour.Send(editor, "OnGUI");
                Expect.That(ReferenceEquals(before, person.Body), "generated again without a change");
                var row = -1;
                User.Answer = (label, value) => label == "slider" && ++row == 3 ? (object)1.61f : null;
                MonoBehaviour.Send(editor, "OnGUI");
                Expect.Near(1.61, person.Body.Measures()[3].obtained, 1e-3, "height");
                Expect.That(person.Body.Measures()[3].Given && !person.Body.Measures()[0].Given, "given");
                User.Answer = (label, value) => label == "waist circumference" ? (object)true : null;
                MonoBehaviour.Send(editor, "OnGUI");
                Expect.That(person.Body.Measures()[0].Given, "the waist is not given");
                User.Answer = (label, value) => label == "waist circumference" ? (object)false : null;
                MonoBehaviour.Send(editor, "OnGUI");
                Expect.That(!person.Body.Measures()[0].Given, "the waist is still given");
                User.Answer = (label, value) => label == "Another person" ? (object)true : null;
                MonoBehaviour.Send(editor, "OnGUI");
                Expect.Equal(1ul, person.Body.Seed, "seed");
                before = person.Body;
                row = -1;
                User.Answer = (label, value) => label == "slider" && ++row == 3 ? (object)9f : null;
                MonoBehaviour.Send(editor, "OnGUI");
                Expect.That(ReferenceEquals(before, person.Body), "a refused request changes the person");
            }
            finally
            {
                User.Answer = null;
                UnityEngine.Object.Destroy(editor.gameObject);
            }
        }

        [Test(Description = "clip player: built-in clips, a motion file, pause and the time slider")]
        public static void Player()
        {
            var file = Path.Combine(Path.GetTempPath(), "anthronet-player-" + System.Diagnostics.Process.GetCurrentProcess().Id + ".bvh");
            File.WriteAllText(file, ClipTests.Bvh);
            var player = new GameObject("player").AddComponent<ClipPlayer>();
            player.file = file;
            try
            {
                MonoBehaviour.Send(player, "Start");
                var animator = player.transform.GetChild(0).gameObject.GetComponent<AnthroAnimator>();
                Expect.That(animator.Clip != null && animator.Clip.FrameCount == 3, "the file does not play");
                User.Answer = (label, value) => label == "walk" ? (object)true : null;
                MonoBehaviour.Send(player, "OnGUI");
                Expect.Equal("walk", animator.Clip.Name, "clip");
                User.Answer = (label, value) => label == "Pause" ? (object)true : label == "slider" ? (object)0.25f : null;
                MonoBehaviour.Send(player, "OnGUI");
                Expect.Equal(0f, animator.Speed, "speed");
                Expect.Near(0.25, animator.Time, 1e-6, "time");
            }
            finally
            {
                User.Answer = null;
                UnityEngine.Object.Destroy(player.gameObject);
                File.Delete(file);
            }
        }
    }
}
