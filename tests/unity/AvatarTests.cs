using System;
using System.Collections.Generic;
using System.Linq;
using NUnit.Framework;
using UnityEngine;

namespace Anthronet.Tests
{
    /// The humanoid avatar.
    [TestFixture]
    public static class AvatarTests
    {
        [Test(Description = "every bone that a humanoid requires is mapped once, and the avatar is valid")]
        public static void Humanoid()
        {
            var traits = HumanTrait.BoneName;
            var bones = AnthroHumanoid.Bones;
            Expect.Equal(55, bones.Count, "bones");
            foreach (var bone in bones)
            {
                Expect.That(traits.Contains(bone.trait), "Unity has no " + bone.trait);
                Expect.That(!HumanTrait.RequiredBone(Array.IndexOf(traits, bone.trait)) || bone.required, bone.trait + " is required");
            }
            Expect.Equal(55, bones.Select(bone => bone.trait).Distinct().Count(), "different bones");
            Expect.Equal(55, bones.Select(bone => bone.joint).Distinct().Count(), "different joints");
            var character = Scene.Character(2, 3);
            var names = character.Rig.Bones.Select(bone => bone.name).Concat(new[] { "LOD2", "LOD3", character.name }).ToArray();
            Expect.Equal(names.Length, names.Distinct().Count(), "different names");
            Expect.That(character.Avatar != null && character.Avatar.isHuman, "avatar");
            Expect.That(character.GetComponent<Animator>().avatar == character.Avatar, "animator");
            var description = AnthroHumanoid.Describe(character.Rig, character.transform);
            Expect.Equal(character.Rig.Bones.Length + 1, description.skeleton.Length, "skeleton");
            Expect.That(description.human.All(bone => bone.limit.useDefaultValues), "limits");
            // A duplicate name is reported.
            var clash = new GameObject("pelvis");
            clash.transform.SetParent(character.transform, false);
            Debug.Errors.Clear();
            character.Generate();
            Expect.That(character.Avatar == null && Debug.Errors.Any(error => error.Contains("pelvis")), "a duplicate name is not reported");
            Debug.Errors.Clear();
            UnityEngine.Object.Destroy(character.gameObject);
        }

        [Test(Description = "every human parent is above its bone, UpperChest has a Chest, arms are horizontal within a degree")]
        public static void Demands()
        {
            foreach (var sex in new[] { AnthroSex.Female, AnthroSex.Male })
            {
                for (var seed = 1ul; seed <= 5; seed++)
                {
                    var character = AnthroFactory.Create(new AnthroRequest { Sex = sex, Seed = seed, Fill = AnthroFill.Sample },
                        new AnthroSettings { finestLod = 3, coarsestLod = 3 });
                    AvatarBuilder.BuildHumanAvatar(
                        character.gameObject, AnthroHumanoid.Describe(character.Rig, character.transform));
                    Expect.That(AvatarBuilder.Why == null, sex + " " + seed + ": " + AvatarBuilder.Why);
                    Scene.Destroy(character);
                }
            }
        }

        [Test(Description = "the stand-in for AvatarBuilder refuses what Unity's documentation forbids")]
        public static void Refusals()
        {
            var character = Scene.Character(3, 3);
            var good = AnthroHumanoid.Describe(character.Rig, character.transform);
            Action<string, Func<HumanBone[], HumanBone[]>> refused = (why, change) =>
            {
                var bad = good;
                bad.human = change((HumanBone[])good.human.Clone());
                var avatar = AvatarBuilder.BuildHumanAvatar(character.gameObject, bad);
                Expect.That(!avatar.isValid && AvatarBuilder.Why.Contains(why), "not refused: " + why + ", " + AvatarBuilder.Why);
                UnityEngine.Object.Destroy(avatar);
            };
            refused("Head is required", human => human.Where(bone => bone.humanName != "Head").ToArray());
            refused("UpperChest without Chest", human => human.Where(bone => bone.humanName != "Chest").ToArray());
            refused("LeftFoot is not below", human => Swapped(human, "LeftLowerLeg", "LeftFoot"));
            var arm = character.Rig.Find("upperarm_l");
            arm.localRotation = new Quaternion(0.1f, 0f, 0.1f, 0.9899495f);
            refused("is not level", human => human);
            character.Rig.ApplyBindPose();
            Scene.Destroy(character);
        }

        static HumanBone[] Swapped(HumanBone[] human, string first, string second)
        {
            int a = Array.FindIndex(human, bone => bone.humanName == first);
            int b = Array.FindIndex(human, bone => bone.humanName == second);
            human[a].humanName = second;
            human[b].humanName = first;
            return human;
        }

        [Test(Description = "a new avatar keeps the animator's states and parameters")]
        public static void KeepsState()
        {
            var character = Scene.Character(3, 3);
            var animator = character.GetComponent<Animator>();
            animator.runtimeAnimatorController = new RuntimeAnimatorController();
            animator.States = new AnimatorStateInfo[2];
            animator.Has = new[]
            {
                new AnimatorControllerParameter { name = "speed", type = AnimatorControllerParameterType.Float },
                new AnimatorControllerParameter { name = "weapon", type = AnimatorControllerParameterType.Int },
                new AnimatorControllerParameter { name = "armed", type = AnimatorControllerParameterType.Bool },
                new AnimatorControllerParameter { name = "jump", type = AnimatorControllerParameterType.Trigger },
            };
            animator.Play(77, 0, 0.25f);
            animator.Play(78, 1, 3.5f);
            animator.SetFloat(Animator.StringToHash("speed"), 1.5f);
            animator.SetInteger(Animator.StringToHash("weapon"), 3);
            animator.SetBool(Animator.StringToHash("armed"), true);
            var before = animator.avatar;
            character.Request.Set("height", 1.6);
            character.Generate();
            Expect.That(!ReferenceEquals(before, animator.avatar) && animator.avatar == character.Avatar, "the same avatar");
            Expect.Equal(77, animator.GetCurrentAnimatorStateInfo(0).fullPathHash, "state");
            Expect.Equal(3.5f, animator.GetCurrentAnimatorStateInfo(1).normalizedTime, "time");
            Expect.Equal(1.5f, animator.GetFloat(Animator.StringToHash("speed")), "speed");
            Expect.Equal(3, animator.GetInteger(Animator.StringToHash("weapon")), "weapon");
            Expect.That(animator.GetBool(Animator.StringToHash("armed")), "armed");
            Scene.Destroy(character);
        }
    }
}
