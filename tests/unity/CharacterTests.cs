using System;
using System.Collections.Generic;
using System.Linq;
using NUnit.Framework;
using Unity.Collections;
using UnityEngine;

namespace Anthronet.Tests
{
    /// Characters: levels of detail, updates, domain reloads, duplicates, lifetimes.
    [TestFixture]
    public static class CharacterTests
    {
        [Test(Description = "levels of detail share one skeleton")]
        public static void Levels()
        {
            var character = Scene.Character(0, 3);
            var lods = character.GetComponent<LODGroup>().GetLODs();
            Expect.Equal(4, lods.Length, "levels");
            var before = int.MaxValue;
            for (var lod = 0; lod < 4; lod++)
            {
                Expect.That(ReferenceEquals(character.GetRenderer(lod).bones, character.Rig.Bones), "bones of LOD" + lod);
                Expect.That(ReferenceEquals(lods[lod].renderers[0], character.GetRenderer(lod)), "renderer of LOD" + lod);
                var count = character.GetMesh(lod).vertexCount;
                Expect.That(count < before, "LOD" + lod + " has " + count + " vertices");
                before = count;
                Expect.Equal(character.GetMesh(lod).subMeshCount, character.GetRenderer(lod).sharedMaterials.Length, "materials");
            }
            UnityEngine.Object.Destroy(character.gameObject);
        }

        [Test(Description = "a character that is updated in place equals a new one")]
        public static void Update()
        {
            var character = Scene.Character();
            var reports = 0;
            character.OnGenerated += made => reports++;
            var mesh = character.GetMesh(1);
            var root = character.Rig.Bones[0];
            character.Request.Set("height", 1.55).Set("waist_circumference", 1.0);
            character.Generate();
            Expect.Equal(1, reports, "reports");
            Expect.That(ReferenceEquals(mesh, character.GetMesh(1)) && ReferenceEquals(root, character.Rig.Bones[0]), "the same");
            var fresh = AnthroFactory.Create(character.Request, new AnthroSettings { finestLod = 1, coarsestLod = 1 });
            var other = fresh.GetMesh(1);
            Expect.That(mesh.Streams[0].SequenceEqual(other.Streams[0]), "positions and normals");
            Expect.That(mesh.Streams[1].SequenceEqual(other.Streams[1]), "texture coordinates");
            Expect.That(mesh.Indices.SequenceEqual(other.Indices), "triangles");
            Expect.That(mesh.Weights.SequenceEqual(other.Weights), "weights");
            Expect.That(mesh.BonesPerVertex.SequenceEqual(other.BonesPerVertex), "numbers of bones");
            Expect.That(mesh.bindposes.SequenceEqual(other.bindposes), "bind poses");
            Expect.That(character.Rig.Joints.SequenceEqual(fresh.Rig.Joints), "joints");
            // A refused request changes nothing.
            var body = character.Body;
            character.Request.Set("height", 9);
            Expect.Code(AnthroError.Request, "height", character.Generate, "too tall");
            Expect.That(ReferenceEquals(body, character.Body), "another body");
            Expect.Near(1.55, character.Body.Measures()[3].obtained, 1e-4, "height");
            UnityEngine.Object.Destroy(character.gameObject);
            Expect.Throws<ObjectDisposedException>(() => body.Joints(), "the body goes with its character");
            UnityEngine.Object.Destroy(fresh.gameObject);
        }

        [Test(Description = "after a domain reload a character is generated again with the same objects, and nothing leaks")]
        public static void Reload()
        {
            foreach (var playing in new[] { true, false })
            {
                Application.Playing = playing;
                try
                {
                    var home = new GameObject("person");
                    var character = home.AddComponent<AnthroCharacter>();
                    var alive = UnityEngine.Object.Alive;
                    Transform pelvis = character.Rig.Find("pelvis"), lod = character.GetRenderer(2).transform;
                    var body = character.Body;
                    Editor.AnthroReload.Release();
                    Expect.Throws<ObjectDisposedException>(() => body.Joints(), "the body is not released");
                    Scene.Reload(character);
                    Expect.That(character.Body != null && ReferenceEquals(pelvis, character.Rig.Find("pelvis")), "other joints");
                    Expect.That(ReferenceEquals(lod, character.GetRenderer(2).transform), "other children");
                    Expect.That(character.Avatar != null && character.Avatar.isValid, "avatar");
                    Expect.Equal(alive, UnityEngine.Object.Alive, "objects that are alive, playing: " + playing);
                    Scene.Destroy(character);
                }
                finally
                {
                    Application.Playing = true;
                }
            }
        }

        [Test(Description = "Awake generates, destroying leaves nothing behind, in edit mode too")]
        public static void Lifecycle()
        {
            foreach (var playing in new[] { true, false })
            {
                Application.Playing = playing;
                try
                {
                    // Make the materials first: they stay cached.
                    Scene.Destroy(Scene.Character());
                    var before = UnityEngine.Object.Alive;
                    var home = new GameObject("person");
                    var character = home.AddComponent<AnthroCharacter>();
                    Expect.That(character.Body != null && character.GetMesh(0) != null && character.GetMesh(3) != null, "not generated");
                    Scene.Destroy(character);
                    Expect.Equal(before, UnityEngine.Object.Alive, "objects that are alive, playing: " + playing);
                    Expect.Equal(0, Mesh.Pending, "mesh data");
                    Expect.Equal(0, NativeArray<float>.Alive + NativeArray<BoneWeight1>.Alive + NativeArray<byte>.Alive, "arrays");
                }
                finally
                {
                    Application.Playing = true;
                }
            }
        }

        [Test(Description = "in edit mode generated objects are not saved; in play mode they do not outlive their scene")]
        public static void Saved()
        {
            using (Scene.EditMode())
            {
                var character = new GameObject("person").AddComponent<AnthroCharacter>();
                foreach (var one in Generated(character))
                {
                    Expect.That((one.hideFlags & HideFlags.DontSave) == HideFlags.DontSave, one.name + " would be saved");
                }
                Expect.That((character.gameObject.hideFlags & HideFlags.DontSave) == 0, "the character itself is not saved");
                Scene.Destroy(character);
            }
            var played = Scene.Character(2, 3);
            foreach (var one in Generated(played))
            {
                Expect.Equal(HideFlags.None, one.hideFlags, one.name);
            }
            Scene.Destroy(played);
        }

        static IEnumerable<UnityEngine.Object> Generated(AnthroCharacter character)
        {
            yield return character.GetComponent<LODGroup>();
            yield return character.GetComponent<Animator>();
            yield return character.Avatar;
            foreach (var bone in character.Rig.Bones)
            {
                yield return bone.gameObject;
            }
            for (var lod = 0; lod < 4; lod++)
            {
                if (character.GetMesh(lod) != null)
                {
                    yield return character.GetMesh(lod);
                    yield return character.GetRenderer(lod).gameObject;
                }
            }
        }

        [Test(Description = "a duplicate has its own meshes, outlives the original, and has every child once")]
        public static void Copies()
        {
            var original = Scene.Character(2, 3);
            var copy = UnityEngine.Object.Instantiate(original.gameObject).GetComponent<AnthroCharacter>();
            Expect.That(!ReferenceEquals(copy.GetMesh(2), original.GetMesh(2)) && copy.GetMesh(2) != null, "the mesh is shared");
            Expect.That(!ReferenceEquals(copy.Rig.Bones[3], original.Rig.Bones[3]), "joints are shared");
            Expect.Equal(original.transform.childCount, copy.transform.childCount, "children");
            Expect.That(original.GetMesh(2) != null && original.GetRenderer(2).sharedMesh != null, "the original lost its mesh");
            Scene.Destroy(original);
            Expect.That(copy.GetMesh(2).Streams[0].Length > 0 && copy.GetRenderer(2).sharedMesh == copy.GetMesh(2), "lost with it");
            Expect.Equal(11ul, copy.Body.Seed, "another person");
            Expect.That(copy.GetRenderer(2).enabled && copy.Avatar.isValid, "not whole");
            Scene.Destroy(copy);
        }

        [Test(Description = "nothing is visible half made, and an abandoned update leaves the previous body complete")]
        public static void Interrupted()
        {
            var home = new GameObject("person");
            home.SetActive(false);
            var character = home.AddComponent<AnthroCharacter>();
            character.GenerateOnAwake = false;
            home.SetActive(true);
            Expect.That(character.Body == null, "generated although it is not to be");
            var alive = UnityEngine.Object.Alive;
            var steps = character.SetBodyInSteps(AnthroModel.Default.Generate(Scene.Request()));
            var count = 0;
            while (steps.MoveNext())
            {
                count++;
                for (var i = 0; i < home.transform.childCount; i++)
                {
                    var drawn = home.transform.GetChild(i).GetComponent<SkinnedMeshRenderer>();
                    Expect.That(drawn == null || !drawn.enabled, "seen after " + count + " steps");
                }
                if (count == 7)
                {
                    break;
                }
            }
            Expect.That(character.Body == null && character.GetMesh(0) == null, "whole after 7 steps");
            // A later body wins; resuming the first one changes nothing.
            var second = AnthroModel.Default.Generate(Scene.Request(1.6));
            character.SetBody(second);
            Expect.That(!steps.MoveNext() && ReferenceEquals(second, character.Body), "the first went on");
            for (var lod = 0; lod < 4; lod++)
            {
                Expect.That(character.GetMesh(lod) != null && character.GetRenderer(lod).enabled, "LOD" + lod + " is missing");
            }
            // An update that is begun and abandoned: the character keeps its body.
            var streams = character.GetMesh(1).Streams[0].ToArray();
            var begun = character.SetBodyInSteps(AnthroModel.Default.Generate(Scene.Request(1.9)));
            begun.MoveNext();
            begun.MoveNext();
            Expect.Near(1.6, character.Body.Measures()[3].obtained, 1e-3, "height");
            Expect.That(streams.SequenceEqual(character.GetMesh(1).Streams[0]), "half changed");
            Expect.Equal(4 + 1, character.transform.childCount, "children");
            Scene.Destroy(character);
            // The GameObject with its transform and character is destroyed, too.
            Expect.Equal(alive - 3, UnityEngine.Object.Alive, "objects that are alive");
        }

        [Test(Description = "the size of the LODGroup follows the body")]
        public static void Bounds()
        {
            var character = Scene.Character(1, 3);
            var group = character.GetComponent<LODGroup>();
            var tall = group.size;
            var box = character.GetMesh(1).bounds.size;
            Expect.Near(Math.Max(box.x, Math.Max(box.y, box.z)), tall, 1e-5, "the body's extent");
            Expect.Near(0.9, group.localReferencePoint.y, 0.05, "its middle");
            character.Request.Set("height", 1.5);
            character.Generate();
            Expect.That(tall > 1.7f && group.size < tall - 0.2f, "from " + tall + " to " + group.size);
            Scene.Destroy(character);
        }

        [Test(Description = "children of a prefab instance are reused, and those that are not needed are deactivated")]
        public static void Prefabs()
        {
            using (Scene.EditMode())
            {
                var character = new GameObject("person").AddComponent<AnthroCharacter>();
                for (var i = 0; i < character.transform.childCount; i++)
                {
                    character.transform.GetChild(i).gameObject.OfPrefab = true;
                }
                var lod = character.GetRenderer(0);
                character.CoarsestLod = 2;
                Scene.Reload(character);
                Expect.That(ReferenceEquals(lod, character.GetRenderer(0)), "another renderer");
                Expect.That(character.GetMesh(3) == null && !character.transform.Find("LOD3").gameObject.activeSelf, "LOD3 is active");
                for (var i = 0; i < character.transform.childCount; i++)
                {
                    character.transform.GetChild(i).gameObject.OfPrefab = false;
                }
                Scene.Destroy(character);
            }
        }

        [Test(Description = "a character can use a request asset")]
        public static void Asset()
        {
            var asset = ScriptableObject.CreateInstance<AnthroRequestAsset>();
            asset.Request = Scene.Request(1.65);
            var character = Scene.Character(3, 3);
            character.RequestAsset = asset;
            character.Generate();
            Expect.Near(1.65, character.Body.Measures()[3].obtained, 1e-3, "height");
            asset.Request.Set("height", 1.75);
            character.Generate();
            Expect.Near(1.75, character.Body.Measures()[3].obtained, 1e-3, "height");
            Scene.Destroy(character);
            UnityEngine.Object.Destroy(asset);
        }

        [Test(Description = "eyes, teeth, tongue and eyelashes can be left out and added back")]
        public static void BodyOnly()
        {
            var character = Scene.Character(2, 2);
            var all = character.GetMesh(2).vertexCount;
            character.BodyOnly = true;
            character.Generate();
            Expect.That(character.GetMesh(2).vertexCount < all && character.GetMesh(2).subMeshCount == 1, "the rest is there");
            Expect.Equal(1, character.GetRenderer(2).sharedMaterials.Length, "materials");
            character.BodyOnly = false;
            character.Generate();
            Expect.Equal(all, character.GetMesh(2).vertexCount, "vertices");
            Scene.Destroy(character);
        }

        [Test(Description = "a character that awakes with a refused request logs one error and throws nothing")]
        public static void Refused()
        {
            var home = new GameObject("person");
            home.SetActive(false);
            var character = home.AddComponent<AnthroCharacter>();
            character.Request.Set("height", 9);
            Debug.Errors.Clear();
            home.SetActive(true);
            Expect.That(character.Body == null && Debug.Errors.Single().Contains("height"), "not logged, or twice");
            Debug.Errors.Clear();
            Scene.Destroy(character);
            // A disabled component is generated all the same.
            home = new GameObject("person");
            home.SetActive(false);
            character = home.AddComponent<AnthroCharacter>();
            character.enabled = false;
            home.SetActive(true);
            Expect.That(character.Body != null, "not generated");
            Scene.Destroy(character);
        }
    }
}
